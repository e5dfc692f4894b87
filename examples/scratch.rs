use std::time::Instant;
use umbrage_core::View;
use umbrage_lab::{gpu::*, lab::*, stage::*, picture};
use umbrage_truth::*;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let casters = match a[2].as_str() { "both" => Casters::Both, _ => Casters::Material };
    let method = if a[3] == "counter-zfail" { Method::CounterZFail } else { Method::Counter };
    let mut lab = Lab::new(Gpu::open(&AdapterChoice::Auto).unwrap());
    for f in &a[4..] {
        if a[1] == "render" { }
        let t = Instant::now();
        let scene = umbrage_scene::open(f, &()).unwrap();
        let stage = Stage::new(scene, casters, None).unwrap();
        eprintln!("{f}: load+world {:?} {:?}", t.elapsed(), stage.world.report);
        let lights = stage.lights(None);
        let plain: Vec<_> = lights.iter().map(|l| l.light).collect();
        let t = Instant::now();
        let size = if a[1] == "render" { [1280, 720] } else { [640, 360] };
        let s = umbrage_lab::auto_camera::auto_camera(&stage.mesh, &plain, 1.0, 16.0 / 9.0);
        eprintln!("camera {:?} {s:?}", t.elapsed());
        let diag = { let n = &stage.world.bvh.nodes[0]; (n.max - n.min).length() };
        let view = View::look_at(s.eye, s.target, 1.0, diag * 1e-6, size);
        if a[1] == "render" {
            let lit = lab.render(&stage, &lights, &view, method, 3).unwrap();
            let name = std::path::Path::new(f).file_stem().unwrap().to_string_lossy().to_string();
            picture::write_png(std::path::Path::new(&format!("/tmp/pic/{name}.png")), size, &lit.to_rgb8()).unwrap();
            eprintln!("times {:?} paths {:?} quads {} bytes {}", lab.times, lab.lights_by_path(), lab.volumes.quads.len(), lab.uploaded_bytes);
            continue;
        }
        lab.prepare(&stage, &lights, &view, method);
        let t = Instant::now();
        let mask = lab.mask(&stage, &lights, &view).unwrap();
        eprintln!("mask {:?} paths {:?}", t.elapsed(), lab.lights_by_path());
        let t = Instant::now();
        let oracle = Oracle::new(&stage.mesh);
        let j = judge(&oracle, &view, &plain, &mask, &JudgeOptions::default(), &|_, _| ());
        let polys: usize = lab.volumes.lights.iter().map(|l| l.quads.len() + 2 * l.chain.len()).sum();
        let brute: usize = lab.volumes.lights.iter().map(|l| 5 * l.chain.len()).sum();
        eprintln!("judge {:?} samples {} wrong {} ambiguous {} lit {} shadowed {}", t.elapsed(), j.samples, j.wrong, j.ambiguous, j.wrong_lit, j.wrong_shadowed);
        println!("{f} {} {} samples {} wrong {} ambiguous {} ({:.4}%) poly ratio {:.3} capless {:.3}", a[2], a[3], j.samples, j.wrong, j.ambiguous, 100.0 * j.ambiguous as f64 / j.samples as f64, polys as f64 / brute as f64, lab.volumes.quads.len() as f64/brute as f64);
        let lit = if j.wrong > 0 { Some(lab.render(&stage, &lights, &view, method, 0).unwrap()) } else { None };
        let rays = EyeRays::new(&view, NearClip::Clamped);
        for w in j.worst.iter().take(12) { 
            let d = lit.as_ref().unwrap().distance[(w.y * size[0] + w.x) as usize];
            let (x, y) = (w.x as f64 + 0.5, w.y as f64 + 0.5);
            let h = oracle.first_hit(&rays, x, y);
            let n: Vec<_> = [(1., 0.), (-1., 0.), (0., 1.), (0., -1.)].iter().map(|(a, b)| oracle.first_hit(&rays, x + a / 64., y + b / 64.).map(|h| h.triangle)).collect();
            println!("     gpu {d} oracle {h:?} around {n:?}"); println!("   {w:?} {} path {:?}", lights[w.light as usize].name, lab.plan.lights[w.light as usize].path); }
    }
}
