//! A page in a headless Chromium.
//!
//! Takes HTML and a script that looks at it; gives what the script found, and every error that the
//! page raised: exceptions, `console.error`, and loads that its own policy forbade.

mod find;

use std::fs::{self, File};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Once;
use std::time::{Duration, Instant};

use serde_json::Value;

/// How the page is opened.
#[derive(Clone, Copy)]
pub(crate) struct Window {
    pub(crate) dark: bool,
    /// In CSS pixels.
    pub(crate) width: u32,
}

/// What came of it.
#[derive(Debug)]
pub(crate) struct Seen {
    /// What the script returned.
    pub(crate) found: Value,
    pub(crate) errors: Vec<String>,
}

/// Before anything else of the page.
const WATCH: &str = "<script>
const seenErrors = [];
addEventListener('error', (e) => seenErrors.push(`error: ${e.message}`), true);
addEventListener('unhandledrejection', (e) => seenErrors.push(`rejection: ${e.reason}`));
document.addEventListener('securitypolicyviolation', (e) => seenErrors.push(`refused: ${e.blockedURI}`));
console.error = (...what) => seenErrors.push(`console: ${what.join(' ')}`);
</script>";

/// A browser; says so where there is none.
pub(crate) fn browser() -> Option<PathBuf> {
    let found = find::find();
    if found.is_none() {
        // Written past the test harness, which would keep it to itself as the test passes.
        static SAY: Once = Once::new();
        SAY.call_once(|| {
            let line = "skipped: no Chromium here; `cargo xtask test` installs it, or name it in CHROMIUM\n";
            std::io::stderr().write_all(line.as_bytes()).unwrap();
        });
    }
    found
}

/// Opens `html`; `probe` is the body of a function that returns what it found.
pub(crate) fn open(browser: &Path, html: &str, window: Window, probe: &str) -> Seen {
    let name = std::thread::current()
        .name()
        .unwrap_or("page")
        .replace(':', "-");
    let dir = std::env::temp_dir().join(format!(
        "umbrage-browser-{}-{name}-{}-{}",
        std::process::id(),
        window.dark,
        window.width
    ));
    fs::create_dir_all(&dir).unwrap();
    let page = dir.join("page.html");
    let probe = format!(
        "<script>addEventListener('load', () => {{
            let found = null;
            try {{ found = (() => {{ {probe} }})(); }} catch (e) {{ seenErrors.push(`probe: ${{e}}`); }}
            setTimeout(() => {{
                const out = document.createElement('pre');
                out.id = 'seen';
                out.textContent = JSON.stringify({{ found, errors: seenErrors }});
                document.body.append(out);
            }}, 50);
        }});</script></body>"
    );
    let html = html.replacen("<head>", &format!("<head>{WATCH}"), 1);
    let (before, after) = html.rsplit_once("</body>").expect("the page has a body");
    fs::write(&page, format!("{before}{probe}{after}")).unwrap();
    let dom = dump(browser, &dir, &page, window);
    let seen = dom
        .rsplit_once("<pre id=\"seen\">")
        .and_then(|(_, rest)| rest.split_once("</pre>"))
        .map(|(text, _)| {
            let text = text.replace("&lt;", "<").replace("&gt;", ">");
            text.replace("&nbsp;", "\u{a0}").replace("&amp;", "&")
        });
    let seen: Value = serde_json::from_str(&seen.expect("the browser shows the page")).unwrap();
    fs::remove_dir_all(&dir).unwrap();
    let errors = seen["errors"].as_array().unwrap().iter();
    Seen {
        found: seen["found"].clone(),
        errors: errors
            .map(|error| error.as_str().unwrap().to_owned())
            .collect(),
    }
}

/// The document after its scripts, as text.
fn dump(browser: &Path, dir: &Path, page: &Path, window: Window) -> String {
    let out = dir.join("dom");
    let mut command = Command::new(browser);
    command
        // The page is our own, and root has no sandbox.
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--no-first-run",
        ])
        .arg("--virtual-time-budget=3000")
        .arg(format!("--user-data-dir={}", dir.join("profile").display()))
        .arg(format!("--window-size={},900", window.width))
        .arg(format!(
            "--blink-settings=preferredColorScheme={}",
            u8::from(!window.dark)
        ))
        .arg("--dump-dom")
        .arg(page)
        .stdout(Stdio::from(File::create(&out).unwrap()))
        .stderr(Stdio::null());
    let mut child = command.spawn().unwrap();
    let end = Instant::now() + Duration::from_secs(120);
    while child.try_wait().unwrap().is_none() {
        if Instant::now() > end {
            child.kill().unwrap();
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    String::from_utf8_lossy(&fs::read(&out).unwrap()).into_owned()
}
