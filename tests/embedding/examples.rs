//! The examples do what they say, and embedding takes as few lines as promised.

use crate::{dynamic, headless, host_depth, mask_texture};

#[test]
fn headless_writes_a_picture() {
    let folder = std::env::temp_dir().join("umbrage_headless");
    let picture = folder.join(format!("{}.png", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder for temporaries");
    headless::run("gen:city?triangles=2000&lights=16", &picture).expect("a picture");
    let bytes = std::fs::read(&picture).expect("it was written");
    assert!(
        bytes.starts_with(b"\x89PNG") && bytes.len() > 10_000,
        "{} bytes",
        bytes.len()
    );
    std::fs::remove_file(&picture).expect("it can be removed");
}

/// Lit pixels of a picture, in thousandths.
fn lit(picture: &[[f32; 3]]) -> usize {
    let lit = picture.iter().filter(|c| c.iter().sum::<f32>() > 0.0);
    1000 * lit.count() / picture.len()
}

#[test]
fn host_depth_draws_a_lit_hall() {
    use host_depth::common::Gpu;
    let gpu = Gpu::open(umbrage::Shadows::features()).expect("an adapter");
    let picture = host_depth::run(&gpu, [160, 90]).expect("a picture");
    let lit = lit(&picture);
    assert!((300..1000).contains(&lit), "{lit}");
}

#[test]
fn mask_texture_draws_a_lit_hall() {
    use mask_texture::common::Gpu;
    let gpu = Gpu::open(umbrage::Shadows::features()).expect("an adapter");
    let picture = mask_texture::run(&gpu, [160, 90]).expect("a picture");
    let lit = lit(&picture);
    assert!((300..1000).contains(&lit), "{lit}");
}

#[test]
fn dynamic_is_right_in_every_frame_and_notices_when_it_is_not() {
    use dynamic::common::Gpu;
    let gpu = Gpu::open(umbrage::Shadows::features()).expect("an adapter");
    let right = dynamic::run(&gpu, [96, 54], 8, |_| ()).expect("frames");
    for frame in &right {
        assert_eq!(frame.wrong, 0, "{frame:?}");
        assert!(frame.samples > 2_000, "{frame:?}");
    }
    // Ten lamps move and one is lit anew; the rest is built again only near what falls.
    let rebuilt: Vec<u32> = right.iter().map(|frame| frame.stats.rebuilt).collect();
    assert!(rebuilt[1..].iter().all(|&n| n >= 5), "{rebuilt:?}");
    assert!(rebuilt[2..].iter().all(|&n| n < 40), "{rebuilt:?}");
    let wrong = dynamic::run(&gpu, [96, 54], 1, |mask| mask.words.fill(0)).expect("a frame");
    assert!(wrong[0].wrong > 0);
}

/// From nothing to a program with shadows: what `run` of `host_depth` takes, its shader's calls
/// into the library included.
#[test]
fn embedding_takes_less_than_sixty_lines() {
    let rust = include_str!("../../examples/host_depth.rs");
    let body = rust.split("pub(crate) fn run").nth(1).expect("run");
    let body = body.split("\n}\n").next().expect("its end");
    let wgsl = include_str!("../../examples/host_depth.wgsl");
    let calls = wgsl.lines().filter(|line| line.contains("umbrage_"));
    let is_code = |line: &&str| !line.trim().is_empty() && !line.trim().starts_with("//");
    let lines = body.lines().filter(is_code).count() + calls.count();
    assert!((30..60).contains(&lines), "{lines} lines");
    // And only the facade is used for it.
    for other in [
        "umbrage_core",
        "umbrage_wgpu",
        "umbrage_lab",
        "umbrage_scene",
    ] {
        assert!(!rust.contains(other), "{other}");
    }
}
