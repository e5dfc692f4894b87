//! Writes a report of invented figures, for work on the page:
//! `cargo run -p umbrage-report --example specimen -- DIR`.

#[path = "../tests/specimen/mod.rs"]
mod specimen;

use std::path::PathBuf;

use umbrage_report::bench;

fn main() -> std::io::Result<()> {
    let dir = std::env::args_os()
        .nth(1)
        .map_or("target/specimen".into(), PathBuf::from);
    let report = specimen::specimen();
    bench::write(&dir, &report)?;
    print!("{}", bench::terminal(&report));
    println!("{}", dir.join("index.html").display());
    Ok(())
}
