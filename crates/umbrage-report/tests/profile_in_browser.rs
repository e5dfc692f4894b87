//! The page of a profile as a browser sees it: nothing goes wrong, the table sorts and filters, the
//! plan shows every light. Skipped, with a line that says so, without a browser.

mod browser;

use browser::{Window, open};
use serde_json::{Value, json};
use umbrage_report::bench::Picture;
use umbrage_report::profile::{
    Advice, AdviceKind, CpuCost, Frame, GpuCost, LightRow, Pictures, Plan, ProfileReport, Saving,
    Share, Thumbnail, html, trace,
};

const DESKTOP: Window = Window {
    dark: false,
    width: 1280,
};

/// A grey pixel.
fn picture() -> Picture {
    let png = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x01\0\0\0\x01\x08\0\0\0\0\x3a\x7e\x9b\x55\0\0\0\nIDATx\x9cch\0\0\0\x82\0\x81\x77\xcdr\xb6\0\0\0\0IEND\xaeB`\x82";
    Picture {
        size: [64, 48],
        png: png.to_vec(),
    }
}

fn specimen() -> ProfileReport {
    let light = |i: usize| LightRow {
        name: format!("lamp_{i}"),
        kind: if i.is_multiple_of(3) { "spot" } else { "point" }.into(),
        range: Some(4.0),
        position: Some([i as f64, 2.0, (i * i % 17) as f64]),
        path: if i < 20 { "zpass" } else { "skipped" }.into(),
        cpu_us: CpuCost {
            query: 2.0,
            hidden: (i * 5 % 13) as f64,
            ..CpuCost::default()
        },
        gpu_us: Some(GpuCost {
            volume: (i * 7 % 20) as f64,
            light: if i < 20 { 10.0 } else { 0.0 },
        }),
        frame_us: Some((i * 7 % 20) as f64 + if i < 20 { 10.0 } else { 0.0 }),
        frame_share: Some(0.01),
        ..LightRow::default()
    };
    let part = |name: &str, us: f64| Share {
        name: name.into(),
        us,
        share: us / 1000.0,
    };
    ProfileReport {
        scene: "a <scene>".into(),
        size: [64, 48],
        rounds: 3,
        how: vec!["With care.".into()],
        frame: Frame {
            frame_ms: 1.0,
            parts: vec![
                part("lights, one by one", 500.0),
                part("lights in one pass, difference", -50.0),
                part("surface", 200.0),
                part("receivers", 100.0),
                part("plan", 50.0),
                part("remainder", 200.0),
            ],
            build_us: 400.0,
            build_parts: vec![part("lights, one by one", 390.0), part("remainder", 10.0)],
        },
        lights: (0..30).map(light).collect(),
        advice: vec![Advice {
            kind: AdviceKind::ShorterRange,
            lights: vec!["lamp_3".into()],
            of: String::new(),
            text: "lamp_3 reaches behind what can be seen & <more>.".into(),
            predicted: Saving {
                frame_us: Some(12.0),
                build_us: 3.0,
            },
            measured: Some(Saving {
                frame_us: Some(11.0),
                build_us: 3.3,
            }),
            frame_ratio: Some(11.0 / 12.0),
            build_ratio: Some(1.1),
            pixels_changed: 0,
        }],
        pictures: Pictures {
            frame: Some(picture()),
            plan: Some(Plan {
                picture: picture(),
                least: [0.0; 2],
                greatest: [30.0, 17.0],
                eye: [[3.0, 3.0], [1.0, 0.0]],
            }),
            lights: vec![Thumbnail {
                light: 2,
                lit: picture(),
                overdraw: picture(),
            }],
        },
        ..ProfileReport::default()
    }
}

#[test]
fn the_page_opens_with_its_plan_pictures_and_timeline() {
    let Some(browser) = browser::browser() else {
        return;
    };
    let seen = open(
        &browser,
        &html(&specimen()),
        DESKTOP,
        "const shown = (css) => [...document.querySelectorAll(css)].filter((e) => e.getClientRects().length).length;
         return {
            discs: shown('.plan .lamp'), bars: shown('.timeline .bar'), advice: shown('.advice li'),
            pictures: [...document.images].filter((i) => i.naturalWidth > 0).length,
            told: document.querySelector('.plan .lamp').dataset.tip.includes('lit pixels'),
            wide: document.scrollingElement.scrollWidth - document.scrollingElement.clientWidth,
            elsewhere: performance.getEntriesByType('resource').filter((e) => !e.name.startsWith('data:')).length,
         };",
    );
    assert_eq!(seen.errors, [""; 0]);
    // A bar for each light drawn, for three parts on the GPU, and for one on the CPU.
    let wanted = json!({
        "discs": 30, "bars": seen.found["bars"], "advice": 1, "pictures": 3, "told": true, "wide": 0,
        "elsewhere": 0,
    });
    assert_eq!(seen.found, wanted);
    assert!(seen.found["bars"].as_u64() > Some(20), "{}", seen.found);
}

#[test]
fn the_table_of_lights_sorts_and_filters() {
    let Some(browser) = browser::browser() else {
        return;
    };
    let seen = open(
        &browser,
        &html(&specimen()),
        DESKTOP,
        "const table = document.getElementById('light-table');
         const rows = () => [...table.tBodies[0].rows].filter((r) => !r.hidden);
         const names = () => rows().map((r) => r.dataset.method);
         const type = (text) => {
            const box = document.getElementById('light-table-filter');
            box.value = text;
            box.dispatchEvent(new Event('input'));
            return names();
         };
         const head = table.querySelector('[data-key=\"gpu_us.volume\"]');
         head.querySelector('button').click();
         const values = rows().map((r) => r.cells[head.cellIndex].dataset.v ?? null);
         return { all: type('').length, values, spots: type('spot zpass'), none: type('no such lamp'),
            said: document.querySelector('.filtering output').textContent, again: type('').length };",
    );
    assert_eq!(seen.errors, [""; 0]);
    let found = &seen.found;
    // Thirty lights and the remainder, which has no such time and is last.
    assert_eq!((&found["all"], &found["again"]), (&json!(31), &json!(31)));
    let values: Vec<f64> = found["values"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(|v| v.as_str()?.parse().ok())
        .collect();
    assert!(values.len() == 30 && values.is_sorted() && values[0] < values[29]);
    assert_eq!(found["values"][30], Value::Null);
    let spots = found["spots"].as_array().unwrap();
    assert_eq!(spots.len(), 7, "{spots:?}");
    assert_eq!(found["none"], json!([]));
    assert_eq!(found["said"], "0 of 31");
}

#[test]
fn an_empty_profile_opens_without_an_error() {
    let Some(browser) = browser::browser() else {
        return;
    };
    let page = html(&ProfileReport::default());
    let seen = open(&browser, &page, DESKTOP, "return 0;");
    assert_eq!(seen.errors, [""; 0]);
}

/// Where two events of a track overlap without one lying in the other.
fn badly_nested(trace: &Value) -> usize {
    let events = trace["traceEvents"].as_array().unwrap();
    let spans: Vec<[f64; 3]> = events
        .iter()
        .filter(|e| e["ph"] == "X")
        .map(|e| {
            let [tid, ts, dur] = ["tid", "ts", "dur"].map(|key| e[key].as_f64().unwrap());
            [tid, ts, ts + dur]
        })
        .collect();
    let tiny = 1e-6;
    let crosses = |[t, a, b]: &[f64; 3], [u, c, d]: &[f64; 3]| {
        t == u && *a < c - tiny && *c < b - tiny && *d > b + tiny
    };
    let pairs = spans.iter().flat_map(|a| spans.iter().map(move |b| (a, b)));
    pairs.filter(|(a, b)| crosses(a, b)).count()
}

#[test]
fn the_trace_has_every_light_on_both_tracks_and_nests() {
    let trace = trace(&specimen());
    let events = trace["traceEvents"].as_array().unwrap();
    let named = |name: &str| events.iter().filter(|e| e["name"] == name).count();
    assert_eq!((named("lamp_7"), named("lamp_25")), (2, 2));
    assert_eq!((named("build volumes"), named("lights")), (1, 1));
    assert_eq!(badly_nested(&trace), 0);
    // The negative control.
    let mut broken = trace;
    for event in broken["traceEvents"].as_array_mut().unwrap() {
        if event["name"] == "lamp_7" {
            event["dur"] = json!(event["dur"].as_f64().unwrap() + 3.0);
        }
    }
    assert!(badly_nested(&broken) > 0);
}
