//! Colours of values: viridis, which grows evenly lighter and which everybody tells apart.

/// Red, green and blue at nine even steps (S. van der Walt and N. Smith, matplotlib 2015).
const STOPS: [[u8; 3]; 9] = [
    [68, 1, 84],
    [71, 45, 123],
    [59, 82, 139],
    [44, 114, 142],
    [33, 145, 140],
    [40, 174, 128],
    [94, 201, 98],
    [173, 220, 48],
    [253, 231, 37],
];

/// Steps of a picture: areas of one colour take few bytes.
const STEPS: f32 = 63.0;

/// The colour of a share of the scale; grey for no number.
pub fn colour(share: f32) -> [f32; 3] {
    if share.is_nan() {
        return [128.0; 3];
    }
    let share = (share.clamp(0.0, 1.0) * STEPS).round() / STEPS;
    let place = share * (STOPS.len() - 1) as f32;
    let low = (place as usize).min(STOPS.len() - 2);
    let part = place - low as f32;
    std::array::from_fn(|i| {
        let [from, to] = [STOPS[low][i], STOPS[low + 1][i]].map(f32::from);
        from + part * (to - from)
    })
}

/// The scale as a background of CSS.
pub fn css() -> String {
    let stops = STOPS.map(|[r, g, b]| format!("#{r:02x}{g:02x}{b:02x}"));
    format!("linear-gradient(to right,{})", stops.join(","))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lightness_grows_along_the_scale() {
        let lightness = |i: u8| {
            let [r, g, b] = colour(f32::from(i) / 20.0);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        assert!((0..20).all(|i| lightness(i) < lightness(i + 1)));
        assert_eq!(colour(-7.0), [68.0, 1.0, 84.0]);
        assert_eq!(colour(9.0), [253.0, 231.0, 37.0]);
        assert_eq!(colour(f32::NAN), [128.0; 3]);
    }
}
