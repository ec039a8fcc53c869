//! Every figure on its sample data: nothing clipped, nothing over anything, the same bytes each time, numbers handed out.

#![allow(clippy::approx_constant, clippy::disallowed_methods)] // sample data, not mathematics
#![allow(clippy::unwrap_used)]

mod hostile;
mod samples;

use figure::column::{Column, Values};
use figure::scene::{Anchor, Color, Path, Rect, Scene, Stroke};
use figure::text::Line;
use figure::{Style, palette, pdf::pdf, png::png, svg::svg, table::csv};

#[test]
fn no_label_is_clipped_or_covered() {
    for (name, style, figure) in samples::all() {
        let scene = figure.scene(&style);
        assert_eq!(scene.faults(), Vec::<String>::new(), "{name}");
        assert!(!scene.title.is_empty() && scene.description.len() > 20, "{name}: {}", scene.description);
        let words = [&scene.title, &scene.description];
        let plain = |text: &String| !text.contains(['$', '\\']) && !text.contains(" ,") && !text.contains(" .");
        assert!(words.into_iter().all(plain), "{name}: {} {}", scene.title, scene.description);
        assert!(scene.width >= style.width && scene.width < 1.6 * style.width, "{name} is {} mm wide", scene.width);
    }
}

/// Narrow pages and large text are where layouts break.
#[test]
fn nothing_is_clipped_in_other_sizes() {
    for (name, style, figure) in samples::all() {
        for (width, points) in [(0.85 * style.width, 8.0), (style.width, 9.0), (1.3 * style.width, 7.0)] {
            let faults = figure.scene(&Style { points, ..Style::wide(width) }).faults();
            assert_eq!(faults, Vec::<String>::new(), "{name} at {width} mm, {points} points");
            let frames = figure.frames(&Style { points, ..Style::wide(width) });
            for frame in frames.first().into_iter().chain(frames.last()) {
                assert_eq!(frame.faults(), Vec::<String>::new(), "{name} in motion, {width} mm, {points} points");
            }
        }
    }
}

#[test]
fn two_drawings_have_the_same_bytes() {
    let bytes = |name: &str| {
        let all = samples::all();
        let (_, style, figure) = all.iter().find(|s| s.0 == name).unwrap();
        let scene = figure.scene(style);
        (scene.to_string(), svg(&scene), pdf(&scene), png(&scene, 60.0).unwrap())
    };
    for name in ["stress-strain", "main-effects", "contour", "surface", "specimen", "dag"] {
        assert!(bytes(name) == bytes(name), "{name}");
    }
}

/// A drawing with every kind of item.
fn small() -> Scene {
    let mut scene = Scene::new(40.0, 20.0);
    scene.title = "small".into();
    scene.stroke(Path::polyline(&[[2.0, 2.0], [38.0, 18.0]]), Stroke::new(palette::BLUE, 0.4).dashed(&[1.6, 1.1]));
    scene.fill(Path::circle([30.0, 6.0], 3.0), Color(200, 90, 0));
    scene.text(Line::new(r"$\bar\sigma_c$ / MPa", 2.822), [20.0, 12.0], Anchor::Middle, 0.0, palette::INK);
    scene.text(Line::new("turned", 2.822), [5.0, 15.0], Anchor::Start, 90.0, palette::INK);
    let first = scene.items.len();
    scene.fill(Path::rect(Rect::new(30.0, 10.0, 20.0, 20.0)), palette::GREEN);
    scene.group_from(first, Some(Rect::new(28.0, 8.0, 8.0, 8.0)), vec![("x", "0 1".into())]);
    scene
}

/// Written down once; a change means that every stored picture changes: bump the version of the figure's work.
#[test]
fn bytes_of_a_small_drawing_are_pinned() {
    let scene = small();
    let hash = |bytes: &[u8]| blake3::hash(bytes).to_hex()[..16].to_owned();
    let got = [hash(svg(&scene).as_bytes()), hash(&pdf(&scene)), hash(&png(&scene, 150.0).unwrap())];
    assert_eq!(got, PINNED);
}
const PINNED: [&str; 3] = ["ee9f5ec635352656", "dddf1df940c8e9d9", "f5e55ba5bf5cce17"];

#[test]
fn svg_is_small_and_names_its_parts() {
    let text = svg(&small());
    assert!(text.contains("<title>small</title>") && text.contains("aria-label=\"σ\u{304}_c / MPa\""), "{text}");
    assert!(text.contains("data-x=\"0 1\"") && !text.contains("font-family"));
    let (_, style, figure) = samples::all().into_iter().find(|s| s.0 == "specimen").unwrap();
    let picture = svg(&figure.scene(&style));
    let discs = figure.data()[0].len();
    assert!(discs > 20_000 && picture.len() < 14 * discs, "{} bytes for {discs} discs", picture.len());
}

#[test]
fn every_figure_hands_out_its_numbers() {
    for (name, _, figure) in samples::all() {
        let columns = figure.data();
        let rows: Vec<usize> = columns.iter().map(Column::len).collect();
        assert!(rows.len() > 1 && rows[0] > 0 && rows.iter().all(|r| *r == rows[0]), "{name}: {rows:?}");
        let mut keys: Vec<&str> = columns.iter().map(|c| c.key.as_str()).collect();
        keys.sort_unstable();
        keys.dedup();
        assert_eq!(keys.len(), columns.len(), "{name}: two columns of one name");
        let text = csv(&columns);
        let read = ::csv::Reader::from_reader(text.as_bytes()).into_records().filter(Result::is_ok).count();
        assert_eq!(read, rows[0], "{name}");
        let numbers = columns.iter().any(|c| !matches!(c.values, Values::Words(_)));
        assert!(numbers || name == "dag", "{name}: no number in the data");
    }
}

#[test]
fn an_impossible_size_is_refused() {
    let message = png(&small(), 1e6).unwrap_err().to_string();
    assert!(message.contains("40.0 mm × 20.0 mm at 1000000 dpi"), "{message}");
}

/// The check that the others lean on can fail.
#[test]
fn clipped_and_covered_labels_are_found() {
    let mut scene = small();
    let label = || Line::new("label", 2.822);
    scene.text(label(), [38.0, 3.0], Anchor::Start, 0.0, palette::INK);
    scene.text(label(), [20.0, 12.5], Anchor::Middle, 0.0, palette::INK);
    let faults = scene.faults();
    assert!(faults[0].starts_with("“label” leaves the page"), "{faults:?}");
    assert!(faults[1].contains("“label” covers “σ") && faults.len() == 2, "{faults:?}");
    // A turned label beside another: their upright boxes meet, they do not.
    let mut scene = Scene::new(40.0, 40.0);
    for x in [10.0, 14.0] {
        scene.text(Line::new("a slanted label", 2.822), [x, 35.0], Anchor::Start, 45.0, palette::INK);
    }
    assert_eq!(scene.faults(), Vec::<String>::new());
}
