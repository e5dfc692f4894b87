//! HTML tables whose columns sort by a click on their head.
//!
//! Takes columns and rows of cells; gives a `<table>`. The page's script reads `data-v`, the value
//! a cell sorts by, so what is shown may be rounded. Invariant: cells without a value sort last in
//! both directions.

use crate::page::escape;

/// The head of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Column {
    /// What people call it.
    pub name: &'static str,
    /// Its unit; may be empty.
    pub unit: &'static str,
    /// Key of the JSON, shown as a tooltip.
    pub key: &'static str,
    /// Flush right and sorted as numbers, else as text.
    pub numeric: bool,
}

impl Column {
    /// A column of numbers.
    pub(crate) const fn number(name: &'static str, unit: &'static str, key: &'static str) -> Self {
        Self {
            name,
            unit,
            key,
            numeric: true,
        }
    }

    /// A column of words.
    pub(crate) const fn text(name: &'static str, key: &'static str) -> Self {
        Self {
            name,
            unit: "",
            key,
            numeric: false,
        }
    }
}

/// One cell.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cell {
    /// Text as shown.
    pub shown: String,
    /// What a numeric column sorts by; null sorts last.
    pub value: Option<f64>,
    /// Small remarks beside the text, as (class, text).
    pub tags: Vec<(&'static str, String)>,
}

impl Cell {
    /// Text that is sorted as it is shown.
    pub fn text(shown: impl Into<String>) -> Self {
        Self {
            shown: shown.into(),
            ..Self::default()
        }
    }

    /// A number as it is shown, and as it is.
    pub fn number(shown: String, value: Option<f64>) -> Self {
        Self {
            shown,
            value,
            tags: Vec::new(),
        }
    }
}

/// One row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Row {
    /// Classes of the row.
    pub classes: Vec<&'static str>,
    /// What is highlighted together with it.
    pub method: String,
    /// One a column; the first is the row's head.
    pub cells: Vec<Cell>,
}

/// The table in a box that scrolls where it is too wide, below one in which words can be typed that
/// rows must have to be shown. `id` is unique in the page.
pub fn filtered_table(id: &str, caption: &str, columns: &[Column], rows: &[Row]) -> String {
    let id = escape(id);
    format!(
        "<p class=\"filtering\"><label for=\"{id}-filter\">Show rows with</label>\
         <input class=\"filter\" id=\"{id}-filter\" data-for=\"{id}\" type=\"search\">\
         <output></output></p>{}",
        named_table(&format!(" id=\"{id}\""), caption, columns, rows)
    )
}

/// The table in a box that scrolls where it is too wide.
pub fn table(caption: &str, columns: &[Column], rows: &[Row]) -> String {
    named_table("", caption, columns, rows)
}

fn named_table(id: &str, caption: &str, columns: &[Column], rows: &[Row]) -> String {
    let mut html = format!(
        "<div class=\"scroll{}\"><table class=\"sortable\"{id}><caption>{}</caption><thead><tr>",
        if id.is_empty() { "" } else { " tall" },
        escape(caption)
    );
    for column in columns {
        let (class, sort) = if column.numeric {
            ("n", "number")
        } else {
            ("t", "text")
        };
        let unit = match column.unit {
            "" => String::new(),
            unit => format!("<small>{}</small>", escape(unit)),
        };
        html += &format!(
            "<th scope=\"col\" class=\"{class}\" data-sort=\"{sort}\" data-key=\"{key}\" aria-sort=\"none\">\
             <button type=\"button\" title=\"{key}\"><span>{name}</span>{unit}</button></th>",
            key = escape(column.key),
            name = escape(column.name),
        );
    }
    html += "</tr></thead><tbody>";
    for row in rows {
        html += &format!(
            "<tr class=\"{}\" data-method=\"{}\">",
            row.classes.join(" "),
            escape(&row.method)
        );
        for (place, (cell, column)) in row.cells.iter().zip(columns).enumerate() {
            let tag = if place == 0 { "th scope=\"row\"" } else { "td" };
            let end = if place == 0 { "th" } else { "td" };
            let class = if column.numeric { "n" } else { "t" };
            let value = match cell.value {
                Some(value) if column.numeric && value.is_finite() => {
                    format!(" data-v=\"{value}\"")
                }
                _ => String::new(),
            };
            html += &format!("<{tag} class=\"{class}\"{value}>{}", escape(&cell.shown));
            for (class, text) in &cell.tags {
                html += &format!(" <span class=\"tag {class}\">{}</span>", escape(text));
            }
            html += &format!("</{end}>");
        }
        html += "</tr>";
    }
    html + "</tbody></table></div>"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_escaped_and_keep_what_they_sort_by() {
        let column = |numeric| Column {
            name: "n",
            unit: "ms",
            key: "k",
            numeric,
        };
        let row = Row {
            method: "a\"b".into(),
            cells: vec![Cell::text("<i>"), Cell::number("1.23".into(), Some(1.2345))],
            ..Row::default()
        };
        let html = table("x & y", &[column(false), column(true)], &[row]);
        assert!(html.contains("data-method=\"a&quot;b\""));
        assert!(html.contains("&lt;i&gt;") && !html.contains("<i>"));
        assert!(html.contains("<td class=\"n\" data-v=\"1.2345\">1.23</td>"));
        assert!(html.contains("<caption>x &amp; y</caption>"));
    }
}
