//! The HTML report as a browser sees it: nothing goes wrong, plots are there, tables sort, both
//! themes and a narrow window are served. Skipped, with a line that says so, without a browser.

mod browser;
mod specimen;

use std::path::Path;

use browser::{Seen, Window, open};
use serde_json::json;
use umbrage_report::bench::{BenchReport, BenchRow, html, write};
use umbrage_report::page::page;

const DESKTOP: Window = Window {
    dark: false,
    width: 1280,
};

fn report_seen(browser: &Path, window: Window, probe: &str) -> Seen {
    let seen = open(browser, &html(&specimen::specimen()), window, probe);
    assert_eq!(seen.errors, [""; 0]);
    seen
}

#[test]
fn the_written_page_opens_with_its_plots_pictures_and_tables() {
    let Some(browser) = browser::browser() else {
        return;
    };
    let dir = std::env::temp_dir().join(format!("umbrage-report-page-{}", std::process::id()));
    write(&dir, &specimen::specimen()).unwrap();
    let page = std::fs::read_to_string(dir.join("index.html")).unwrap();
    std::fs::remove_dir_all(&dir).unwrap();
    let seen = open(
        &browser,
        &page,
        DESKTOP,
        "const shown = (css) => [...document.querySelectorAll(css)].filter((e) => e.getClientRects().length).length;
         return {
            tradeOffs: shown('.plot.trade-off'), scalings: shown('.plot.scaling'),
            spots: shown('#over-all .spot'), tables: shown('table.sortable'),
            pictures: [...document.querySelectorAll('.pictures img')].filter((i) => i.naturalWidth > 100).length,
            elsewhere: performance.getEntriesByType('resource').filter((e) => !e.name.startsWith('data:')).length,
         };",
    );
    assert_eq!(seen.errors, [""; 0]);
    // Eight views and all of them; the city grows in lights at two sizes, all four scenes in pixels.
    let wanted = json!({
        "tradeOffs": 9, "scalings": 6, "spots": 15, "tables": 5, "pictures": 36, "elsewhere": 0,
    });
    assert_eq!(seen.found, wanted);
}

#[test]
fn a_click_on_a_head_sorts_and_another_one_turns_it_round() {
    let Some(browser) = browser::browser() else {
        return;
    };
    let seen = report_seen(
        &browser,
        DESKTOP,
        "const table = document.querySelector('#scene-1 table');
         const head = (key) => table.querySelector(`[data-key=${key}]`);
         const read = (key) => ({
            sort: head(key).ariaSort,
            values: [...table.tBodies[0].rows].map((r) => r.cells[head(key).cellIndex].dataset.v ?? null),
            methods: [...table.tBodies[0].rows].map((r) => r.dataset.method),
         });
         const click = (key) => { head(key).querySelector('button').click(); return read(key); };
         return { up: click('wrong'), down: click('wrong'), text: click('method'), after: read('wrong').sort };",
    );
    let values = |way: &str| -> Vec<Option<f64>> {
        let list = seen.found[way]["values"].as_array().unwrap();
        list.iter()
            .map(|v| v.as_str().map(|text| text.parse().unwrap()))
            .collect()
    };
    let (up, down) = (values("up"), values("down"));
    assert_eq!(up.len(), 30);
    // The failed row has no value and stays last both ways.
    assert!(up[..29].is_sorted() && up[0] == Some(0.0), "{up:?}");
    assert!(
        down[..29].is_sorted_by(|a, b| a >= b) && down[0] > Some(1.0),
        "{down:?}"
    );
    assert_eq!((up[29], down[29]), (None, None));
    assert_eq!(seen.found["up"]["sort"], "ascending");
    assert_eq!(seen.found["down"]["sort"], "descending");
    assert_eq!(seen.found["after"], "none");
    let methods = seen.found["text"]["methods"].as_array().unwrap();
    let place = |name| methods.iter().position(|method| method == name).unwrap();
    assert!(place("brute") < place("counter"));
    // Numbers in names count as numbers.
    assert!(place("shadowmap-512") < place("shadowmap-1024"));
}

#[test]
fn a_mark_tells_its_figures_and_lights_up_everywhere() {
    let Some(browser) = browser::browser() else {
        return;
    };
    let seen = report_seen(
        &browser,
        DESKTOP,
        "const tip = document.querySelector('.tip');
         const hidden = tip.hidden;
         document.querySelector('#scene-0 .wide .spot[data-method=counter]').dispatchEvent(new Event('pointerenter'));
         return {
            hidden, shown: !tip.hidden, text: tip.innerText,
            on: [...new Set([...document.querySelectorAll('.on')].map((e) => e.dataset.method))],
            titles: document.querySelectorAll('.spot title').length,
         };",
    );
    assert_eq!(seen.found["hidden"], true);
    assert_eq!(seen.found["shown"], true);
    let text = seen.found["text"].as_str().unwrap();
    assert!(
        text.starts_with("counter\n") && text.contains("0 wrong"),
        "{text}"
    );
    assert_eq!(seen.found["on"], json!(["counter"]));
    assert_eq!(seen.found["titles"], 0);
}

#[test]
fn the_dark_theme_is_dark_and_the_light_one_light() {
    let Some(browser) = browser::browser() else {
        return;
    };
    let seen = [false, true].map(|dark| {
        let window = Window { dark, ..DESKTOP };
        report_seen(
            &browser,
            window,
            "const bright = (css, what) => {
                const rgb = getComputedStyle(document.querySelector(css))[what].match(/[0-9]+/g).map(Number);
                return rgb[0] + rgb[1] + rgb[2];
             };
             return {
                paper: bright('body', 'backgroundColor'), ink: bright('body', 'color'),
                label: bright('.plot .label', 'fill'), mark: bright('.spot.c0 .mark', 'stroke'),
                row: bright('tr.best', 'backgroundColor'),
             };",
        )
    });
    let value = |dark: usize, key: &str| seen[dark].found[key].as_i64().unwrap();
    for dark in [0, 1] {
        let sign = if dark == 1 { 1 } else { -1 };
        for on_paper in ["ink", "label", "mark"] {
            let contrast = sign * (value(dark, on_paper) - value(dark, "paper"));
            assert!(contrast > 200, "{on_paper}: {:?}", seen[dark].found);
        }
    }
    assert!(value(0, "paper") > 700 && value(1, "paper") < 100);
    assert!(value(0, "row") > 600 && value(1, "row") < 150);
}

#[test]
fn a_narrow_window_shows_narrow_plots_and_nothing_hangs_over_the_edge() {
    let Some(browser) = browser::browser() else {
        return;
    };
    let window = Window {
        width: 500,
        ..DESKTOP
    };
    let seen = report_seen(
        &browser,
        window,
        "const shown = (css) => document.querySelector(css).getClientRects().length > 0;
         const page = document.scrollingElement;
         return [shown('.narrow'), shown('.wide'), page.scrollWidth - page.clientWidth];",
    );
    assert_eq!(seen.found, json!([true, false, 0]));
}

#[test]
fn empty_and_hostile_reports_open_without_an_error() {
    let Some(browser) = browser::browser() else {
        return;
    };
    let empty = open(
        &browser,
        &html(&BenchReport::default()),
        DESKTOP,
        "return 0;",
    );
    assert_eq!(empty.errors, [""; 0]);
    let mut report = BenchReport::default();
    let hostile = "<script>throw 1</script>\"'&.glb";
    let mut row = BenchRow::new(hostile, (hostile, hostile, [8, 8]));
    row.set_frame_times(&[1.0]);
    row.note = hostile.into();
    report.push(row);
    let seen = open(
        &browser,
        &html(&report),
        DESKTOP,
        "return document.querySelector('tbody tr').dataset.method;",
    );
    assert_eq!(seen.errors, [""; 0]);
    assert_eq!(seen.found, hostile);
}

/// The negative control: what the tests above rely on does see errors.
#[test]
fn a_page_that_goes_wrong_is_caught() {
    let Some(browser) = browser::browser() else {
        return;
    };
    for (wrong, sign) in [
        ("<script>noSuchFunction()</script>", "noSuchFunction"),
        ("<script>console.error('no')</script>", "console: no"),
        ("<img src=\"http://example.invalid/x.png\">", "refused"),
        ("<script>const = 1</script>", "SyntaxError"),
    ] {
        let seen = open(&browser, &page("t", wrong), DESKTOP, "return 0;");
        let caught = seen.errors.iter().any(|error| error.contains(sign));
        assert!(caught, "{wrong}: {:?}", seen.errors);
    }
}
