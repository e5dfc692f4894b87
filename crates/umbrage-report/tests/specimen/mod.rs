//! A report of invented figures, plausible in size: for looking at the page, and for its tests.

use umbrage_report::bench::{BenchReport, BenchRow, Difference, Machine, Picture};

/// (method, exact, build ms, GPU ms at a megapixel and a hundred lights, wrong ppm, MiB).
const METHODS: [(&str, bool, f64, f64, f64, f64); 15] = [
    ("none", false, 0.0, 10.0, 92_000.0, 0.0),
    ("counter", true, 1.2, 12.4, 0.0, 1.9),
    ("counter-zfail", true, 1.3, 21.0, 0.0, 2.6),
    ("brute", true, 0.9, 58.0, 0.0, 9.1),
    ("crow", false, 2.2, 13.1, 640.0, 2.2),
    ("extrude", true, 0.1, 74.0, 0.0, 48.0),
    ("mask-alpha", false, 1.2, 31.0, 3.4, 12.0),
    ("mask-max", true, 1.2, 33.5, 0.0, 12.0),
    ("half", false, 1.2, 11.4, 5_200.0, 3.1),
    ("shadowmap-256", false, 3.0, 14.0, 21_000.0, 24.0),
    ("shadowmap-512", false, 3.1, 16.2, 10_400.0, 96.0),
    ("shadowmap-1024", false, 3.2, 21.5, 5_050.0, 384.0),
    ("shadowmap-2048", false, 3.3, 36.0, 2_600.0, 1_536.0),
    ("shadowmap-4096", false, 3.6, 92.0, 1_280.0, 6_144.0),
    ("raytrace", true, 0.4, 66.0, 0.0, 31.0),
];

/// (scene, lights, triangles, extra factor of the shadow methods).
const SCENES: [(&str, u64, u64, f64); 4] = [
    ("data/worlds/colosseum.glb", 203, 235_924, 1.0),
    ("data/worlds/stormkeep.glb", 471, 98_112, 0.7),
    ("gen:city?triangles=100000&lights=64", 64, 100_020, 1.2),
    ("gen:city?triangles=100000&lights=256", 256, 100_020, 1.2),
];

const SIZES: [[u32; 2]; 2] = [[1280, 720], [1920, 1080]];

/// Three kinds of scene, fifteen methods, two sizes, one method that fails.
pub(crate) fn specimen() -> BenchReport {
    let mut report = BenchReport {
        command: "umbrage bench data/worlds/colosseum.glb data/worlds/stormkeep.glb \
            'gen:city?triangles=100000&lights=64' 'gen:city?triangles=100000&lights=256' \
            --methods none,counter,counter-zfail,brute,crow,extrude,mask-alpha,mask-max,half,\
            shadowmap-256,shadowmap-512,shadowmap-1024,shadowmap-2048,shadowmap-4096,raytrace \
            --size 1280x720 --size 1920x1080 --camera auto --repeat 5 -o bench"
            .into(),
        when: "2026-05-17T09:30:00Z".into(),
        machine: Machine {
            cpu: "Invented Processor 9000 @ 3.6 GHz".into(),
            cores: 16,
            threads: 8,
            memory_gib: Some(31.2),
            os: "Debian GNU/Linux 12 (x86_64)".into(),
            adapter: "Invented Graphics 70".into(),
            driver: "radv, Mesa 25.1".into(),
            version: "0.1.0".into(),
        },
        complete: true,
        oracle: true,
        repeat: 5,
        ..BenchReport::default()
    };
    for scene in SCENES {
        for size in SIZES {
            for method in METHODS {
                report.push(row(scene, size, method));
            }
        }
    }
    report
}

fn row(
    (scene, lights, triangles, factor): (&str, u64, u64, f64),
    size: [u32; 2],
    (method, exact, build, gpu, ppm, mib): (&str, bool, f64, f64, f64, f64),
) -> BenchRow {
    let mut row = BenchRow::new(method, (scene, "auto", size));
    row.exact = exact;
    (row.lights, row.triangles) = (lights, triangles);
    if method == "raytrace" && scene.contains("stormkeep") && size[0] > 1500 {
        row.failed = Some("the adapter allows storage buffers of 128 MiB, 212 are needed".into());
        return row;
    }
    let megapixels = f64::from(size[0]) * f64::from(size[1]) / 1e6;
    let floor = 0.4 + 0.02 * megapixels.powf(0.9) * lights as f64;
    let shadows = (gpu - 10.0) * 0.006 * lights as f64 * factor * megapixels.powf(0.7);
    let build = build * (lights as f64 / 100.0).powf(0.9);
    let frame = floor + shadows + build;
    row.set_frame_times(&[0.97, 0.99, 1.0, 1.03, 1.09].map(|wobble| frame * wobble));
    row.build_ms = Some(build);
    row.first_frame_ms = Some(frame + build + 20.0);
    row.gpu_ms = Some(floor + shadows);
    row.gpu_bytes = Some((mib * 1_048_576.0 * lights as f64 / 200.0) as u64);
    let samples = (megapixels * 1e6 * lights as f64 * 0.011) as u64;
    // Two of the city's ambiguities turn out wrong for the doubling mask; elsewhere it is lucky.
    let ppm = if method == "mask-alpha" && !scene.contains("city") {
        0.0
    } else {
        ppm * factor
    };
    let wrong = (ppm * samples as f64 / 1e6) as u64;
    let ambiguous = if method == "none" {
        0
    } else {
        samples / 70_000 + wrong / 60
    };
    row.set_errors(wrong, ambiguous, samples);
    if method == "shadowmap-4096" && lights > 200 {
        row.note = format!("maps cached for 120 of {lights} lights");
    }
    if size == SIZES[0] && !exact {
        row.difference = Some(difference(size, ppm));
    }
    row
}

/// Rings and stripes, with errors along their edges: the more, the higher `ppm`.
fn difference(size: [u32; 2], ppm: f64) -> Picture {
    let [width, height] = size.map(|side| side as usize);
    let (mut grey, mut wrong, mut ambiguous) = (vec![], vec![], vec![]);
    let reach = ppm.max(1.0).log10() as f32 * 0.012;
    for y in 0..height {
        for x in 0..width {
            let [u, v] = [
                x as f32 / height as f32 - 0.9,
                y as f32 / height as f32 - 0.6,
            ];
            let ring = (u * u + 2.0 * v * v).sqrt() * 6.0;
            let edge = (ring.fract() - 0.5).abs();
            let shade =
                0.85 - 0.3 * v - 0.25 * u.abs() - if ring.fract() > 0.5 { 0.35 } else { 0.0 };
            grey.push(shade);
            let near = edge < reach && ppm > 0.0 && ring > 1.0;
            wrong.push(if near { 1 + (ring * 2.0) as u32 } else { 0 });
            ambiguous.push(u32::from(edge < 0.004 && (x * 7 + y * 3) % 5 == 0));
        }
    }
    Difference::new(size, &grey, &wrong, &ambiguous)
        .and_then(|difference| difference.picture())
        .unwrap()
}
