//! A comparison as a table for the terminal: a heading a view, a line a method, a count below.

use super::{Change, Comparison, Measure, Regression};
use crate::bench::rows::name;
use crate::figure::{count_or_dash, figure};
use crate::{Table, grouped};

impl Regression {
    fn name(self) -> &'static str {
        match self {
            Self::Slower => "SLOWER",
            Self::LessExact => "LESS EXACT",
            Self::PromiseBroken => "MUST BE 0",
            Self::Fails => "FAILS",
            Self::NotJudged => "NOT JUDGED",
            Self::OtherWorkload => "OTHER WORKLOAD",
            Self::Missing => "MISSING",
        }
    }
}

/// Rows that a summary names.
const NAMED: usize = 3;

impl Comparison {
    /// In one line: how many rows are worse, and the first of them with what is.
    pub fn summary(&self) -> String {
        let worse: Vec<&Change> = self.worse().collect();
        let named = |one: &&Change| {
            let row = name(&one.method, &one.scene, &one.camera, one.size);
            format!("{row} ({})", names(one))
        };
        let named: Vec<String> = worse.iter().take(NAMED).map(named).collect();
        let rows = if worse.len() == 1 { "row" } else { "rows" };
        let more = match worse.len().saturating_sub(NAMED) {
            0 => String::new(),
            more => format!("; and {more} more"),
        };
        let count = worse.len();
        format!(
            "{count} {rows} worse than the baseline: {}{more}",
            named.join("; ")
        )
    }
}

fn names(change: &Change) -> String {
    let names: Vec<&str> = change.regressions.iter().map(|one| one.name()).collect();
    names.join(", ")
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
        let unjudged = self
            .changes
            .iter()
            .filter(|one| matches!(one.wrong, [Some(_), None]));
        let (worse, rows) = (self.worse().count() as u64, self.changes.len() as u64);
        let allowed = figure(self.ratio);
        writeln!(
            f,
            "\n{} of {} rows worse (ratio {allowed} allowed)",
            grouped(worse),
            grouped(rows)
        )?;
        if self.same_machine {
            let allowed = figure(1.0 + 2.0 * (self.ratio - 1.0));
            writeln!(
                f,
                "none itself is compared in ms: the machine is the same (ratio {allowed} allowed)"
            )?;
        }
        if !self.judged {
            return writeln!(f, "Errors were not compared: this run asked no oracle");
        }
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
    let remark = match change.new && change.regressions.is_empty() {
        true => "new".to_owned(),
        false => names(change),
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
