//! Colours and markers.

use plotters::style::RGBColor;

/// Units of the drawing in a pixel: elements are placed at whole units.
pub(super) const UNIT: i32 = 10;

/// Axes and text: as far from white as from the dark of pages.
pub(super) const INK: RGBColor = RGBColor(0x80, 0x80, 0x80);

/// For people who confuse red and green (Okabe & Ito 2008), orange and sky blue darkened to stand
/// out from white.
pub(super) const COLOURS: [RGBColor; 6] = [
    RGBColor(0x00, 0x72, 0xB2),
    RGBColor(0xD5, 0x5E, 0x00),
    RGBColor(0x00, 0x9E, 0x73),
    RGBColor(0xCC, 0x79, 0xA7),
    RGBColor(0xB8, 0x80, 0x00),
    RGBColor(0x38, 0x92, 0xC4),
];

/// The same hues on light and on dark pages, ink last. No colour stands out from both as text must,
/// by 4.5 to 1 (WCAG 2.1, 1.4.3); viewers that know no style sheets show those above.
const ADAPTED: [[RGBColor; 2]; 7] = [
    [RGBColor(0x00, 0x72, 0xB2), RGBColor(0x4D, 0xA3, 0xDB)],
    [RGBColor(0xB8, 0x4F, 0x00), RGBColor(0xF0, 0x80, 0x3C)],
    [RGBColor(0x00, 0x78, 0x5A), RGBColor(0x1F, 0xB5, 0x8E)],
    [RGBColor(0xA8, 0x44, 0x7C), RGBColor(0xD8, 0x8B, 0xB8)],
    [RGBColor(0x86, 0x60, 0x00), RGBColor(0xCC, 0x9A, 0x2B)],
    [RGBColor(0x22, 0x71, 0x9C), RGBColor(0x6D, 0xB8, 0xE0)],
    [RGBColor(0x57, 0x60, 0x6A), RGBColor(0x91, 0x98, 0xA1)],
];

/// A style sheet that gives the colours of a drawing the shades that suit its background.
pub(super) fn style_sheet(drawing: &str) -> String {
    let drawn = COLOURS.into_iter().chain([INK]);
    let used = drawn.zip(ADAPTED);
    let used: Vec<_> = used
        .map(|(colour, adapted)| (hex(colour), adapted.map(hex)))
        .filter(|(colour, _)| drawing.contains(colour.as_str()))
        .collect();
    let rules = |shade: usize| -> String {
        let rule = |(colour, shades): &(String, [String; 2])| {
            let shade = &shades[shade];
            format!("[fill='{colour}']{{fill:{shade}}}[stroke='{colour}']{{stroke:{shade}}}")
        };
        used.iter().map(rule).collect()
    };
    let (light, dark) = (rules(0), rules(1));
    format!("<style>{light}@media (prefers-color-scheme:dark){{{dark}}}</style>\n")
}

/// As the drawing has it.
fn hex(RGBColor(r, g, b): RGBColor) -> String {
    format!("#{r:02X}{g:02X}{b:02X}")
}

/// Half the width of a marker (units).
const SIZE: f64 = 4.5 * UNIT as f64;

/// Corners of the marker of a series around a place: circle, square, triangle, diamond, triangle
/// upside down, hexagon; series beyond the colours have other markers on the same colours.
pub(super) fn marker(series: usize, (x, y): (i32, i32)) -> Vec<(i32, i32)> {
    // Corners, turn of the first one from the right (of a whole turn), radius.
    let (corners, turn, radius) = [
        (24, 0.0, 1.0),
        (4, 0.125, 1.25),
        (3, -0.25, 1.3),
        (4, 0.0, 1.4),
        (3, 0.25, 1.3),
        (6, 0.0, 1.15),
    ][(series + series / COLOURS.len()) % 6];
    let corner = |i: i32| {
        let angle = std::f64::consts::TAU * (turn + f64::from(i) / f64::from(corners));
        let place = |origin: i32, part: f64| origin + (SIZE * radius * part).round() as i32;
        (place(x, angle.cos()), place(y, angle.sin()))
    };
    (0..corners).map(corner).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance and contrast of WCAG 2.1.
    fn luminance(RGBColor(r, g, b): RGBColor) -> f64 {
        let part = |value: u8| {
            let share = f64::from(value) / 255.0;
            if share <= 0.04045 {
                share / 12.92
            } else {
                ((share + 0.055) / 1.055).powf(2.4)
            }
        };
        0.2126 * part(r) + 0.7152 * part(g) + 0.0722 * part(b)
    }

    #[test]
    fn everything_stands_out_from_light_and_dark_pages() {
        let (white, dark) = (1.05, luminance(RGBColor(0x0D, 0x11, 0x17)) + 0.05);
        for colour in COLOURS.into_iter().chain([INK]) {
            let own = luminance(colour) + 0.05;
            assert!(white / own >= 3.0, "{colour:?}: {}", white / own);
            assert!(own / dark >= 3.0, "{colour:?}: {}", own / dark);
        }
        for shades in ADAPTED {
            let [on_light, on_dark] = shades.map(|shade| luminance(shade) + 0.05);
            assert!(white / on_light >= 4.5, "{shades:?}: {}", white / on_light);
            assert!(on_dark / dark >= 4.5, "{shades:?}: {}", on_dark / dark);
        }
    }
}
