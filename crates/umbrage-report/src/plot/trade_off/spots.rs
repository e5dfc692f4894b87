//! What is drawn for the spots: curves through some, a mark and a label for each.
//!
//! Takes spots and where they are; gives SVG.

use super::Spot;
use crate::page::escape;
use crate::plot::{Anchor, Frame, GLYPH, LabelBox, LogScale, Look, place};

/// A line that joins spots of one name.
pub(super) struct Curve {
    look: Look,
    pub(super) places: Vec<[f64; 2]>,
}

/// All curves of two spots or more.
pub(super) fn curves(spots: &[&Spot], at: impl Fn(&Spot) -> [f64; 2]) -> Vec<Curve> {
    let mut by_value: Vec<(&str, f64, &Spot)> = spots
        .iter()
        .filter_map(|spot| {
            let (name, value) = spot.curve.as_ref()?;
            Some((name.as_str(), *value, *spot))
        })
        .collect();
    by_value.sort_by(|a, b| a.0.cmp(b.0).then(a.1.total_cmp(&b.1)));
    by_value
        .chunk_by(|a, b| a.0 == b.0)
        .filter(|of_name| of_name.len() > 1)
        .map(|of_name| Curve {
            look: of_name[0].2.look,
            places: of_name.iter().map(|(_, _, spot)| at(spot)).collect(),
        })
        .collect()
}

pub(super) fn draw_curve(curve: &Curve) -> String {
    let places: Vec<String> = curve
        .places
        .iter()
        .map(|[x, y]| format!("{x:.1} {y:.1}"))
        .collect();
    format!(
        "<path class=\"curve {}\" d=\"M{}\"/>",
        curve.look.classes(),
        places.join("L")
    )
}

pub(super) fn marks(spots: &[&Spot], at: impl Fn(&Spot) -> [f64; 2], x: &LogScale) -> String {
    let mut svg = String::new();
    for spot in spots {
        let [px, py] = at(spot);
        svg += &format!(
            "<g class=\"spot {}\" data-method=\"{}\" tabindex=\"0\"><title>{}</title>\
             <circle class=\"hit\" cx=\"{px:.1}\" cy=\"{py:.1}\" r=\"11\"/>",
            spot.look.classes(),
            escape(&spot.name),
            escape(&spot.tip)
        );
        if let Some((least, greatest)) = spot.span.filter(|span| span.0 > 0.0) {
            let [from, to] = [least, greatest].map(|time| x.at(time));
            svg += &format!(
                "<path class=\"whisker\" d=\"M{from:.1} {py:.1}H{to:.1}M{from:.1} {:.1}v5M{to:.1} {:.1}v5\"/>",
                py - 2.5,
                py - 2.5
            );
        }
        svg += &spot.look.mark([px, py]);
        svg += "</g>";
    }
    svg
}

pub(super) fn labels(
    spots: &[&Spot],
    at: impl Fn(&Spot) -> [f64; 2],
    lines: &[[[f64; 2]; 2]],
    frame: &Frame,
) -> String {
    let anchors: Vec<Anchor> = spots
        .iter()
        .map(|spot| Anchor {
            at: at(spot),
            text: spot.name.clone(),
        })
        .collect();
    let bounds = LabelBox {
        min: [frame.left + 2.0, frame.top - 4.0],
        max: [frame.right, frame.bottom - 1.0],
    };
    let mut svg = String::new();
    for (anchor, label) in anchors.iter().zip(place(&anchors, lines, &bounds)) {
        let [x, y] = anchor.at;
        let [near_x, near_y] = label.nearest(anchor.at);
        let name = escape(&anchor.text);
        let (dx, dy) = (near_x - x, near_y - y);
        let away = dx.hypot(dy);
        if away > 11.0 {
            // From the rim of the mark to the label.
            let [from_x, from_y] = [x + dx / away * 6.0, y + dy / away * 6.0];
            svg += &format!(
                "<path class=\"leader\" data-method=\"{name}\" d=\"M{from_x:.1} {from_y:.1}L{near_x:.1} {near_y:.1}\"/>"
            );
        }
        // Flush to the side of its mark, whatever the true width of the font.
        let (text_x, side) = if label.min[0] >= x {
            (label.min[0], "start")
        } else if label.max[0] <= x {
            (label.max[0], "end")
        } else {
            ((label.min[0] + label.max[0]) / 2.0, "middle")
        };
        svg += &format!(
            "<text class=\"label\" data-method=\"{name}\" x=\"{text_x:.1}\" y=\"{:.1}\" text-anchor=\"{side}\">{name}</text>",
            label.max[1] - GLYPH[1] * 0.24
        );
    }
    svg
}
