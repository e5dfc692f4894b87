//! A comparison as a table for the terminal: a heading a view, a line a method, a count below.

use super::{Change, Comparison, Measure, Regression};
use crate::figure::{count_or_dash, figure};
use crate::{Table, grouped};

impl Regression {
    fn name(self) -> &'static str {
        match self {
            Self::Slower => "SLOWER",
            Self::LessExact => "LESS EXACT",
            Self::PromiseBroken => "MUST BE 0",
            Self::Fails => "FAILS",
            Self::Missing => "MISSING",
        }
    }
}

impl std::fmt::Display for Comparison {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut view = None;
        let mut table = Table::default();
        for change in &self.changes {
            let of = (&change.scene, &change.camera, change.size);
            if view != Some(of) {
                write!(f, "{table}")?;
                let [width, height] = change.size;
                let gap = if view.is_some() { "\n" } else { "" };
                writeln!(f, "{gap}{}, camera {}, {width}x{height}", of.0, of.1)?;
                table = Table::default();
                table.row([
                    "method",
                    "before",
                    "now",
                    "",
                    "ratio",
                    "wrong before",
                    "now",
                    "",
                ]);
                view = Some(of);
            }
            table.row(cells(change));
        }
        write!(f, "{table}")?;
        let worse = self
            .changes
            .iter()
            .filter(|one| !one.regressions.is_empty());
        let unjudged = self
            .changes
            .iter()
            .filter(|one| matches!(one.wrong, [Some(_), None]));
        let (worse, rows) = (worse.count() as u64, self.changes.len() as u64);
        let allowed = figure(self.ratio);
        writeln!(
            f,
            "\n{} of {} rows worse (ratio {allowed} allowed)",
            grouped(worse),
            grouped(rows)
        )?;
        match unjudged
            .filter(|one| !one.regressions.contains(&Regression::Missing))
            .count()
        {
            0 => Ok(()),
            count => writeln!(
                f,
                "{count} rows that the baseline judged were not judged now"
            ),
        }
    }
}

fn cells(change: &Change) -> [String; 8] {
    let [before, now, unit, ratio] = match change.time {
        Some((measure, before, now)) => {
            let unit = match measure {
                Measure::TimesNone => "x none",
                Measure::FrameMs => "ms",
            };
            [
                figure(before),
                figure(now),
                unit.to_owned(),
                format!("{:.2}", now / before),
            ]
        }
        None => Default::default(),
    };
    let names: Vec<&str> = change.regressions.iter().map(|one| one.name()).collect();
    let remark = if change.new && names.is_empty() {
        "new".to_owned()
    } else {
        names.join(", ")
    };
    let [was, is] = change.wrong.map(count_or_dash);
    [
        change.method.clone(),
        before,
        now,
        unit,
        ratio,
        was,
        is,
        remark,
    ]
}
