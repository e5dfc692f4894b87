//! Numbers as people read them.
//!
//! Takes f64; gives text with two or three significant digits, and all of a whole number's, without
//! an exponent as long as that is readable. Invariant: what is not finite reads as a dash, never as `NaN`.

use crate::grouped;

/// What stands where nothing was measured.
pub(crate) const NONE: &str = "\u{2013}";

/// 0.0012, 0.012, 0.12, 1.23, 45.6, 1,234.
pub(crate) fn figure(value: f64) -> String {
    if !value.is_finite() {
        return NONE.to_owned();
    }
    if value < 0.0 {
        return format!("-{}", figure(-value));
    }
    match value {
        0.0 => "0".to_owned(),
        v if v < 0.0001 => format!("{v:.1e}"),
        // The limits are those at which three digits would round up to four.
        v if v < 0.00995 => format!("{v:.4}"),
        v if v < 0.0995 => format!("{v:.3}"),
        v if v < 9.995 => format!("{v:.2}"),
        v if v < 99.95 => format!("{v:.1}"),
        v if v < 1e15 => grouped(v.round() as u64),
        v => format!("{v:.2e}"),
    }
}

/// [`figure`], or a dash.
pub(crate) fn figure_or_dash(value: Option<f64>) -> String {
    value.map_or_else(|| NONE.to_owned(), figure)
}

/// [`grouped`], or a dash.
pub(crate) fn count_or_dash(value: Option<u64>) -> String {
    value.map_or_else(|| NONE.to_owned(), grouped)
}

/// `1 row`, `2 rows`.
pub(crate) fn plural(count: usize, noun: &str) -> String {
    let s = if count == 1 { "" } else { "s" };
    format!("{} {noun}{s}", grouped(count as u64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_few_digits_and_no_exponent_where_it_can_be_helped() {
        let texts = [0.0, 0.0123, 1.234, 9.996, 45.67, 123.4, 12_345.6].map(figure);
        assert_eq!(
            texts,
            ["0", "0.012", "1.23", "10.0", "45.7", "123", "12,346"]
        );
        assert_eq!(figure(f64::NAN), NONE);
        assert_eq!(figure(-1.5), "-1.50");
    }
}
