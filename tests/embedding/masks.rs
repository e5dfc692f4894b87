//! Masks: the same by every way, and the oracle's.

use umbrage::wgpu::{Features, TextureFormat};
use umbrage::{Host, Shadows};

use crate::common::{Site, data};
use crate::host::{BITS, Drawing, GPU, Given, cropped, differences, hall, open, truth};
use crate::host_depth::common::DEPTH;
use umbrage_lab::stage::Casters;

const SIZE: [u32; 2] = [200, 120];

fn stormkeep() -> Site {
    Site::new(data("worlds/stormkeep.glb"), Casters::Material)
}

fn host() -> Host {
    Host::new(DEPTH, &[Some(BITS)]).with_mask()
}

#[test]
fn a_mask_of_300_lights_is_what_callbacks_draw_and_the_oracle_says() {
    let site = stormkeep();
    let given = Given::new(&site, 300);
    let (view, plain) = hall(&site, site.near(), SIZE);
    let mut drawing = Drawing::new(&GPU, host(), 1, &given.world);
    let mut eyes = [drawing.view()];
    let mask = drawing.masks(&given, &[view], &mut eyes, SIZE).remove(0);
    let called = drawing.by_callback(&given, view, SIZE, |_| false);
    assert_eq!(differences(&mask, &called), 0);
    let lit: u32 = mask.words.iter().map(|w| w.count_ones()).sum();
    assert!(lit > 10_000, "{lit} bits are 1");
    let judgement = truth(&site, &plain, &mask);
    assert_eq!(judgement.wrong, 0, "{:?}", judgement.worst);
    assert!(judgement.samples > 10_000, "{}", judgement.samples);

    // Who draws one light less differs in its bits, and in no other.
    let brightest = (0..300).max_by_key(|&light| bits_of(&mask, light)).unwrap();
    let without = drawing.by_callback(&given, view, SIZE, |light| light == brightest);
    let missed = differences(&mask, &without);
    assert_eq!(missed, bits_of(&mask, brightest));
    assert!(missed > 100, "{missed}");
    assert!(truth(&site, &plain, &without).wrong > 0);
}

fn bits_of(mask: &umbrage_truth::Mask, light: u32) -> u32 {
    let pixels = (mask.size[0] * mask.size[1]) as usize;
    let words = &mask.words[(light / 32) as usize * pixels..][..pixels];
    words.iter().map(|word| word >> (light % 32) & 1).sum()
}

/// Near planes that leave ordinary depth the precision it needs; reversed depth is right with any.
#[test]
fn ordinary_depth_gives_the_oracles_mask_too() {
    let site = stormkeep();
    let given = Given::new(&site, 300);
    let (view, plain) = hall(&site, 4.0, SIZE);
    let packed = Host::new(TextureFormat::Depth24PlusStencil8, &[Some(BITS)]).with_mask();
    let hosts = [
        host(),
        host().with_ordinary_depth(),
        packed.with_ordinary_depth(),
    ];
    let mut masks = hosts.map(|host| {
        let mut drawing = Drawing::new(&GPU, host, 1, &given.world);
        let mut eyes = [drawing.view()];
        drawing.masks(&given, &[view], &mut eyes, SIZE).remove(0)
    });
    for mask in &masks {
        let judgement = truth(&site, &plain, mask);
        assert_eq!(judgement.wrong, 0, "{:?}", judgement.worst);
        assert!(judgement.samples > 2_000, "{}", judgement.samples);
    }
    let middle = masks[1].words.len() / 2;
    masks[1].words[middle..].fill(0);
    assert!(truth(&site, &plain, &masks[1]).wrong > 0);
}

#[test]
fn a_viewport_in_a_larger_target_gives_the_plain_mask() {
    let site = stormkeep();
    let given = Given::new(&site, 64);
    let (view, _) = hall(&site, site.near(), SIZE);
    let mut drawing = Drawing::new(&GPU, host(), 1, &given.world);
    let mut eyes = [drawing.view()];
    let plain = drawing.masks(&given, &[view], &mut eyes, SIZE).remove(0);
    let (origin, target) = ([37, 21], [300, 200]);
    let moved = view.viewport_at(origin);
    let large = drawing.masks(&given, &[moved], &mut eyes, target).remove(0);
    assert_eq!(differences(&cropped(&large, origin, SIZE), &plain), 0);
    let inside: u32 = plain.words.iter().map(|w| w.count_ones()).sum();
    let all: u32 = large.words.iter().map(|w| w.count_ones()).sum();
    assert_eq!(all, inside, "bits outside of the viewport");
    assert_ne!(differences(&cropped(&large, [36, 21], SIZE), &plain), 0);
    let called = drawing.by_callback(&given, moved, target, |_| false);
    assert_eq!(differences(&called, &large), 0);
}

#[test]
fn two_views_of_one_submission_do_not_disturb_each_other() {
    let site = stormkeep();
    let given = Given::new(&site, 64);
    let (left, plain) = hall(&site, site.near(), SIZE);
    let back = plain.eye - 30.0 * plain.forward.as_dvec3() + 10.0 * plain.up.as_dvec3();
    let right = umbrage::View::look_at(back, plain.eye, 0.8, site.near(), SIZE);
    let target = [2 * SIZE[0], SIZE[1]];
    let beside = [SIZE[0], 0];
    let views = [left, right.viewport_at(beside)];

    let mut drawing = Drawing::new(&GPU, host(), 1, &given.world);
    let alone = [left, right].map(|view| {
        let mut eyes = [drawing.view()];
        drawing.masks(&given, &[view], &mut eyes, SIZE).remove(0)
    });
    assert_ne!(differences(&alone[0], &alone[1]), 0);
    // Twice: what is kept from frame to frame must not go stale when buffers grow.
    let mut fresh = Drawing::new(&GPU, host(), 1, &given.world);
    let mut eyes = [fresh.view(), fresh.view()];
    for _ in 0..2 {
        let both = fresh.masks(&given, &views, &mut eyes, target);
        assert_eq!(differences(&cropped(&both[0], [0; 2], SIZE), &alone[0]), 0);
        assert_eq!(differences(&cropped(&both[1], beside, SIZE), &alone[1]), 0);
    }
}

/// With four samples a pixel, light is drawn by callbacks. Receivers are not looked for then, so they
/// are not with one sample either, for bits beyond the light's range to be alike. Of 128 lights that are
/// drawn one after the other every eighth is marked: it has a channel alone, in which the mean of its
/// samples can be read.
#[test]
fn four_samples_agree_with_one_away_from_edges() {
    let site = stormkeep();
    let given = Given::new(&site, 128);
    let skip = |light| light % 8 != 0;
    let gpu = open(Shadows::features() - Features::INDIRECT_FIRST_INSTANCE);
    let (view, _) = hall(&site, site.near(), SIZE);
    let mut one = Drawing::new(&gpu, host(), 1, &given.world);
    let one = one.by_callback(&given, view, SIZE, skip);
    let smooth = Host::new(DEPTH, &[Some(BITS)]);
    let mut four = Drawing::new(&gpu, smooth, 4, &given.world);
    let four = four.by_callback(&given, view, SIZE, skip);
    let interior = |x: u32, y: u32, light: u32| {
        let lit = one.get(x, y, light);
        let mut around = (y - 1..=y + 1).flat_map(|y| (x - 1..=x + 1).map(move |x| (x, y)));
        around.all(|(x, y)| one.get(x, y, light) == lit)
    };
    let mut judged = 0;
    for light in (0..128).step_by(8) {
        let mut counts = [0; 2];
        let mut differing = 0;
        for (x, y) in (1..SIZE[1] - 1).flat_map(|y| (1..SIZE[0] - 1).map(move |x| (x, y))) {
            if interior(x, y, light) {
                counts[usize::from(one.get(x, y, light))] += 1;
                differing += u32::from(one.get(x, y, light) != four.get(x, y, light));
            }
        }
        judged += u32::from(counts.iter().all(|&count| count > 200));
        assert!(
            differing * 1000 <= counts[0] + counts[1],
            "{light}: {differing} of {counts:?}"
        );
    }
    assert!(
        judged > 2,
        "{judged} lights light and leave dark much of the view"
    );
}

/// Without depth clamping lights take the path with caps, without indirect draws nothing is culled
/// on the GPU.
#[test]
fn a_device_without_optional_features_gives_the_oracles_mask() {
    let site = stormkeep();
    let given = Given::new(&site, 64);
    let gpu = open(Features::DEPTH32FLOAT_STENCIL8);
    let (view, plain) = hall(&site, site.near(), SIZE);
    let mut drawing = Drawing::new(&gpu, host(), 1, &given.world);
    let mut eyes = [drawing.view()];
    let mask = drawing.masks(&given, &[view], &mut eyes, SIZE).remove(0);
    let judgement = truth(&site, &plain, &mask);
    assert_eq!(judgement.wrong, 0, "{:?}", judgement.worst);
}
