//! Colours, line styles and markers that can be told apart by the colour-blind and in grey.
//!
//! Categories: the palette of Okabe and Ito (2008), reordered so that neighbours differ in lightness; each series
//! also has its own dash and marker. Sequences: viridis and cividis (matplotlib, CC0; Nuñez et al. 2018,
//! doi:10.1371/journal.pone.0199239) at 17 points, linear between. Two-sided: computed in Oklab (Ottosson 2020).

use super::scene::Color;
use math::elementary::{cbrt, pow};

/// Text and frames.
pub const INK: Color = Color(0x22, 0x26, 0x2b);
/// Secondary text, ticks.
pub const SOFT: Color = Color(0x5c, 0x63, 0x6b);
/// Grid lines.
pub const GRID: Color = Color(0xe3, 0xe6, 0xea);
/// Ground of bands and boxes.
pub const WASH: Color = Color(0xf2, 0xf4, 0xf6);
/// Ground of tolerance bands.
pub const BAND: Color = Color(0xe4, 0xec, 0xf3);
/// White.
pub const PAPER: Color = Color(0xff, 0xff, 0xff);

/// Blue, first of the categories.
pub const BLUE: Color = Color(0x00, 0x72, 0xb2);
/// Vermilion, second.
pub const VERMILION: Color = Color(0xd5, 0x5e, 0x00);
/// Bluish green.
pub const GREEN: Color = Color(0x00, 0x9e, 0x73);
/// Orange.
pub const ORANGE: Color = Color(0xe6, 0x9f, 0x00);
/// Reddish purple.
pub const PURPLE: Color = Color(0xcc, 0x79, 0xa7);
/// Sky blue.
pub const SKY: Color = Color(0x56, 0xb4, 0xe9);

const CATEGORIES: [Color; 7] = [BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY, INK];
const DASHES: [&[f64]; 7] = [&[], &[1.6, 1.1], &[0.01, 0.9], &[2.6, 0.9, 0.01, 0.9], &[3.4, 1.0], &[], &[0.8, 0.8]];

/// Shape of a data point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marker {
    /// ●
    Disc,
    /// ■
    Square,
    /// ▲
    Triangle,
    /// ◆
    Diamond,
    /// ▼
    Down,
    /// ✚
    Plus,
    /// ✖
    Cross,
}

const MARKERS: [Marker; 7] =
    [Marker::Disc, Marker::Square, Marker::Triangle, Marker::Diamond, Marker::Down, Marker::Plus, Marker::Cross];

/// Colour of category number `i`.
pub fn category(i: usize) -> Color {
    CATEGORIES[i % CATEGORIES.len()]
}

/// Colour of crack mode `i`: vermilion (tension), dark blue (shear; darker in grey too), then others.
pub fn mode(i: usize) -> Color {
    [VERMILION, Color(0x0b, 0x3c, 0x6f), GREEN, PURPLE, ORANGE, SKY][i % 6]
}

/// Colour of class `i` of damage, the last one for what is wholly broken: light orange to dark red, in grey from light to dark.
pub fn damage(i: usize) -> Color {
    [Color(0xf5, 0xb0, 0x65), Color(0xe0, 0x75, 0x2d), Color(0xb0, 0x3a, 0x1e), Color(0x5c, 0x0f, 0x14)][i.min(3)]
}

/// Colour of category number `i` for areas: lightness differs more than between lines, so that areas differ in grey.
pub fn area(i: usize) -> Color {
    [BLUE, ORANGE, Color(0xa6, 0xdb, 0xc4), PURPLE, SKY, VERMILION][i % 6]
}

/// Colour of group `i` for lines, in the hue of its areas.
pub fn group(i: usize) -> Color {
    [BLUE, Color(0xc2, 0x77, 0x00), GREEN, PURPLE, VERMILION, INK][i % 6]
}

/// Dash of category number `i`.
pub fn dash(i: usize) -> &'static [f64] {
    DASHES[i % DASHES.len()]
}

/// Marker of category number `i`.
pub fn marker(i: usize) -> Marker {
    MARKERS[i % MARKERS.len()]
}

/// A continuous colour map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Map {
    /// Dark blue to yellow.
    #[default]
    Viridis,
    /// Like viridis, but nearly the same for all kinds of colour vision.
    Cividis,
    /// White to black.
    Grey,
    /// Blue over white to vermilion, for signed values.
    Diverging,
}

const VIRIDIS: [u32; 17] = [
    0x440154, 0x48186a, 0x472d7b, 0x424086, 0x3b528b, 0x33638d, 0x2c728e, 0x26828e, 0x21918c, 0x1fa088, 0x28ae80,
    0x3fbc73, 0x5ec962, 0x84d44b, 0xaddc30, 0xd8e219, 0xfde725,
];
const CIVIDIS: [u32; 17] = [
    0x00224e, 0x002e6a, 0x1a386f, 0x32436d, 0x434e6c, 0x535a6d, 0x61656f, 0x6f7073, 0x7d7c78, 0x8c8878, 0x9b9476,
    0xaba072, 0xbcae6c, 0xcdbb63, 0xdec958, 0xf0d846, 0xfee838,
];

impl Map {
    /// The colour at `t` in 0 … 1 (clamped).
    pub fn at(self, t: f64) -> Color {
        let t = if t.is_finite() { t.clamp(0.0, 1.0) } else { 0.0 };
        match self {
            Map::Viridis => tabulated(&VIRIDIS, t),
            Map::Cividis => tabulated(&CIVIDIS, t),
            Map::Grey => Color(0xf7, 0xf7, 0xf7).mix(Color(0x1c, 0x1c, 0x1c), t),
            Map::Diverging => {
                let side = if t < 0.5 { Color(0x00, 0x5a, 0x9c) } else { Color(0xb8, 0x45, 0x00) };
                oklab_mix(Color(0xf6, 0xf5, 0xf3), side, (2.0 * t - 1.0).abs())
            }
        }
    }
}

fn tabulated(table: &[u32; 17], t: f64) -> Color {
    let place = t * 16.0;
    let i = (place.floor() as usize).min(15);
    let color = |rgb: u32| Color((rgb >> 16) as u8, (rgb >> 8) as u8, rgb as u8);
    color(table[i]).mix(color(table[i + 1]), place - i as f64)
}

/// Mixes in Oklab, in which equal steps look equal.
pub fn oklab_mix(a: Color, b: Color, t: f64) -> Color {
    let (p, q) = (oklab(a), oklab(b));
    from_oklab(std::array::from_fn(|k| p[k] + (q[k] - p[k]) * t))
}

/// Lightness and two opponent axes of a colour (Ottosson 2020).
fn oklab(Color(r, g, b): Color) -> [f64; 3] {
    let linear = |c: u8| {
        let c = f64::from(c) / 255.0;
        if c <= 0.040_45 { c / 12.92 } else { pow((c + 0.055) / 1.055, 2.4) }
    };
    let (r, g, b) = (linear(r), linear(g), linear(b));
    let l = cbrt(0.412_221_470_8 * r + 0.536_332_536_3 * g + 0.051_445_992_9 * b);
    let m = cbrt(0.211_903_498_2 * r + 0.680_699_545_1 * g + 0.107_396_956_6 * b);
    let s = cbrt(0.088_302_461_9 * r + 0.281_718_837_6 * g + 0.629_978_700_5 * b);
    [
        0.210_454_255_3 * l + 0.793_617_785_0 * m - 0.004_072_046_8 * s,
        1.977_998_495_1 * l - 2.428_592_205_0 * m + 0.450_593_709_9 * s,
        0.025_904_037_1 * l + 0.782_771_766_2 * m - 0.808_675_766_0 * s,
    ]
}

fn from_oklab([lightness, a, b]: [f64; 3]) -> Color {
    let l = lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b;
    let m = lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b;
    let s = lightness - 0.089_484_177_5 * a - 1.291_485_548_0 * b;
    let (l, m, s) = (l * l * l, m * m * m, s * s * s);
    let code = |v: f64| {
        let v = v.clamp(0.0, 1.0);
        let v = if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * pow(v, 1.0 / 2.4) - 0.055 };
        (v * 255.0).round() as u8
    };
    Color(
        code(4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s),
        code(-1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s),
        code(-0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_rise_in_lightness() {
        for map in [Map::Viridis, Map::Cividis] {
            let light: Vec<f64> = (0..=64).map(|i| oklab(map.at(f64::from(i) / 64.0))[0]).collect();
            assert!(light.windows(2).all(|w| w[1] > w[0]), "{map:?} {light:?}");
        }
        assert_eq!(Map::Viridis.at(0.0), Color(0x44, 0x01, 0x54));
    }

    #[test]
    fn oklab_of_known_colours() {
        let near = |got: [f64; 3], want: [f64; 3]| got.iter().zip(want).all(|(g, w)| (g - w).abs() < 2e-4);
        // Ottosson's table: white (1, 0, 0); red of sRGB (0.6280, 0.2249, 0.1258).
        assert!(near(oklab(PAPER), [1.0, 0.0, 0.0]), "{:?}", oklab(PAPER));
        assert!(near(oklab(Color(255, 0, 0)), [0.6280, 0.2249, 0.1258]));
        for c in [BLUE, VERMILION, Color(12, 200, 99)] {
            assert_eq!(from_oklab(oklab(c)), c);
        }
    }

    #[test]
    fn damage_darkens() {
        let light: Vec<f64> = (0..4).map(|i| oklab(damage(i))[0]).collect();
        assert!(light.windows(2).all(|w| w[0] - w[1] > 0.1), "{light:?}");
    }

    #[test]
    fn categories_stay_apart_in_grey_or_by_their_line() {
        for i in 0..6 {
            for j in 0..i {
                let apart = (oklab(category(i))[0] - oklab(category(j))[0]).abs() > 0.05;
                assert!(apart || dash(i) != dash(j) && marker(i) != marker(j), "{i} {j}");
            }
        }
    }
}
