//! What is refused, and in what words: no panic, and no error of the validation layer.

use umbrage::wgpu::{Features, TextureFormat, TextureUsages};
use umbrage::{Casting, Error, Host, Light, Lights, Mesh, Pose, Shadows, View, World};

use crate::host::{GPU, open};
use crate::host_depth::common::{DEPTH, HDR};

const CORNERS: [[f32; 3]; 3] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

fn world() -> World {
    World::build(&[Mesh::new(&CORNERS, &[0, 1, 2])]).expect("a world")
}

fn view() -> View {
    View::look_at([0.0, 0.0, 3.0], [0.0; 3], 1.0, 0.1, [64, 64])
}

#[test]
fn handles_of_what_was_removed_are_refused() {
    let mut world = world();
    let mesh = Mesh::new(&CORNERS, &[0, 1, 2]);
    let pose = Pose::at([1.0, 0.0, 0.0]);
    let old = world.insert(&mesh, &pose).expect("an object");
    world.remove(old).expect("it is there");
    let new = world.insert(&mesh, &pose).expect("another, in its place");
    for result in [
        world.place(old, &pose),
        world.remove(old),
        world.corners_of(Some(old)).map(|_| ()),
        world.deform(old, &CORNERS),
    ] {
        assert!(matches!(result, Err(Error::Object(_))), "{result:?}");
    }
    world.place(new, &pose).expect("the new one is there");
    assert!(world.corners_of(Some(new)).is_ok_and(|r| r.len() == 3));
    let other = self::world().remove(new);
    assert!(matches!(other, Err(Error::Object(_))), "of another world");

    let mut lights = Lights::default();
    let lamp = Light::point([0.0; 3], 1.0);
    let old = lights.insert(lamp).expect("a light");
    lights.remove(old).expect("it is there");
    let new = lights.insert(lamp).expect("another, in its place");
    assert_eq!(old.slot(), new.slot());
    for result in [lights.set(old, lamp), lights.remove(old)] {
        assert!(matches!(result, Err(Error::UnknownLight)), "{result:?}");
    }
    assert_eq!(lights.get(new).ok(), Some(lamp));
    let other = Lights::default().get(new);
    assert!(matches!(other, Err(Error::UnknownLight)), "of another set");
    assert_eq!((lights.len(), lights.slots()), (1, 1));
}

#[test]
fn what_is_no_light_mesh_or_pose_is_refused() {
    let mut lights = Lights::default();
    for light in [
        Light::point([f64::NAN, 0.0, 0.0], 1.0),
        Light::point([0.0; 3], 0.0),
        Light::spot([0.0; 3], [0.0; 3], 0.5, 1.0),
        Light::spot([0.0; 3], [0.0, 1.0, 0.0], 4.0, 1.0),
        Light::directional([0.0; 3]),
        Light::directional([f32::NAN; 3]),
    ] {
        let result = lights.insert(light);
        assert!(matches!(result, Err(Error::Light)), "{light:?}");
    }
    assert!(lights.is_empty());

    let mesh = Mesh::new(&CORNERS, &[0, 1, 2]);
    let build = |mesh| World::build(&[mesh]).map(|_| ());
    assert!(matches!(
        build(Mesh::new(&CORNERS, &[0, 1])),
        Err(Error::Indices { .. })
    ));
    let both = [Casting::Both; 2];
    assert!(matches!(
        build(mesh.casting(&both)),
        Err(Error::Casting { .. })
    ));
    // Of a vertex that the next mesh has.
    let reaching = [Mesh::new(&CORNERS, &[0, 1, 3]), mesh];
    assert!(matches!(World::build(&reaching), Err(Error::World(_))));
    let nowhere = Pose::new([0.0; 3], [0.0; 4]);
    let inserted = world().insert(&mesh, &nowhere);
    assert!(matches!(inserted, Err(Error::Object(_))), "{inserted:?}");
}

#[test]
fn formats_that_cannot_be_are_refused_at_creation() {
    let world = world();
    let new = |device, host: &Host| Shadows::new(device, &world, host).map(|_| ());
    let device = &GPU.device;
    let host = Host::new(DEPTH, &[Some(HDR)]);
    new(device, &host).expect("this one can");
    for format in [TextureFormat::Depth32Float, TextureFormat::Stencil8, HDR] {
        let result = new(device, &Host::new(format, &[Some(HDR)]));
        assert!(matches!(result, Err(Error::Format { .. })), "{result:?}");
    }
    for samples in [0, 3, 64] {
        let result = new(device, &host.clone().with_samples(samples));
        assert!(matches!(result, Err(Error::Format { .. })), "{result:?}");
    }
    let compressed = Host::new(DEPTH, &[Some(TextureFormat::Rgb9e5Ufloat)]);
    let result = new(device, &compressed);
    assert!(matches!(result, Err(Error::Format { .. })), "{result:?}");
    let many = Host::new(DEPTH, &[Some(HDR); 40]);
    assert!(matches!(new(device, &many), Err(Error::Device(_))));
    let result = new(device, &host.clone().with_samples(4).with_mask());
    assert!(matches!(result, Err(Error::MaskSamples { samples: 4 })));
    let bare = open(Features::empty());
    let result = new(&bare.device, &host);
    let words = result.unwrap_err().to_string();
    assert!(words.contains("Shadows::features()"), "{words}");
}

#[test]
fn textures_views_and_masks_that_do_not_fit_are_refused() {
    let (device, queue) = (&GPU.device, &GPU.queue);
    let (world, mut lights) = (world(), Lights::default());
    for _ in 0..33 {
        lights
            .insert(Light::point([0.0, 0.0, 1.0], 5.0))
            .expect("a light");
    }
    let host = Host::new(DEPTH, &[Some(HDR)]);
    let masked = host.clone().with_mask();
    let new = |host| Shadows::new(device, &world, host).expect("a renderer");
    let (mut shadows, plain) = (new(&masked), new(&host));
    let mut eye = shadows.view(device).expect("a view");
    let mut stranger = plain.view(device).expect("a view");

    let mut prepare = |eye: &mut _, view| {
        let prepared = shadows.prepare(device, queue, &world, &lights, [(eye, view)]);
        prepared.map(|_| ())
    };
    assert!(matches!(
        prepare(&mut stranger, view()),
        Err(Error::ForeignView)
    ));
    for bad in [
        View::look_at([f64::NAN; 3], [0.0; 3], 1.0, 0.1, [64, 64]),
        View::look_at([0.0, 0.0, 3.0], [0.0; 3], 4.0, 0.1, [64, 64]),
        View::look_at([0.0, 0.0, 3.0], [0.0; 3], 1.0, 0.0, [64, 64]),
        View::look_at([0.0, 0.0, 3.0], [0.0; 3], 1.0, 0.1, [64, 0]),
        View::new(
            [0.0; 3],
            [0.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
            1.0,
            0.1,
            [64, 64],
        ),
    ] {
        let result = prepare(&mut eye, bad);
        assert!(
            matches!(result, Err(Error::View { .. })),
            "{bad:?}: {result:?}"
        );
    }
    prepare(&mut eye, view()).expect("a view of this renderer");

    let mut encoder = GPU.encoder();
    let depth = GPU.target([64, 64], DEPTH);
    let unreadable = device.create_texture(&umbrage::wgpu::TextureDescriptor {
        label: None,
        size: depth.size(),
        mip_level_count: 1,
        sample_count: 1,
        dimension: depth.dimension(),
        format: DEPTH,
        usage: TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    });
    for depth in [
        unreadable,
        GPU.target([63, 64], DEPTH),
        GPU.target([64, 64], HDR),
    ] {
        let result = shadows.find_receivers(device, &mut encoder, &mut eye, &depth);
        assert!(matches!(result, Err(Error::Depth { .. })), "{result:?}");
    }
    assert!(matches!(
        plain.mask(device, [64, 64], 1),
        Err(Error::NoMask)
    ));
    let too_large = shadows.mask(device, [64, 1 << 20], 1);
    assert!(matches!(too_large, Err(Error::MaskTooLarge { .. })));
    for (size, lights) in [([64, 64], 32), ([128, 64], 33)] {
        let mask = shadows.mask(device, size, lights).expect("a mask");
        let result = shadows.record_mask(&mut encoder, &eye, &depth, &mask);
        assert!(matches!(result, Err(Error::Mask { .. })), "{result:?}");
    }
    let mask = shadows.mask(device, [64, 64], 33).expect("a mask");
    let recorded = shadows.record_mask(&mut encoder, &eye, &depth, &mask);
    recorded.expect("this one fits");
    let foreign = shadows.record_mask(&mut encoder, &stranger, &depth, &mask);
    assert!(matches!(foreign, Err(Error::ForeignView)), "{foreign:?}");
}
