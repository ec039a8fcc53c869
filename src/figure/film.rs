//! Scenes one after another → one SVG that moves: small, deterministic, without a script.
//!
//! What several scenes share is written once, with the part of the loop in which it is seen; CSS shows and hides it. A
//! reader without motion (a printer, a word processor, or a person who asked the system for less of it) sees the last scene.
//! The pointer over the picture stops it where the picture is the document itself.

use super::scene::{Item, Scene};
use super::svg;
use std::collections::BTreeSet;
use std::fmt::Write;

/// An item with the scenes in which it is seen, from the first one to the last.
struct Part<'a> {
    item: &'a Item,
    from: usize,
    to: usize,
}

/// The moving picture; each scene stands for `each` seconds, the last one three times as long and at least a second. `None`
/// without scenes, or when they differ in size.
pub fn film(scenes: &[Scene], each: f64) -> Option<String> {
    let last = scenes.last()?;
    if scenes.iter().any(|scene| [scene.width, scene.height] != [last.width, last.height]) {
        return None;
    }
    let rest = (3.0 * each).max(1.0);
    let seconds = each * (scenes.len() - 1) as f64 + rest;
    // The share of the loop at which a scene begins, in per mille.
    let start =
        |scene: usize| if scene >= scenes.len() { 1000 } else { (1e3 * each * scene as f64 / seconds).round() as u32 };
    let parts = merged(scenes);
    let mut spans: BTreeSet<(usize, usize)> = BTreeSet::new();
    let mut body = Vec::new();
    for part in &parts {
        let span = (part.from, part.to);
        let whole = span == (0, scenes.len() - 1);
        if !whole {
            spans.insert(span);
        }
        body.push((part.item, (!whole).then(|| class(span))));
    }
    let mut style = String::new();
    for &(from, to) in &spans {
        let (name, at, end) = (class((from, to)), start(from), start(to + 1));
        let still = if to + 1 == scenes.len() { "" } else { "visibility:hidden;" };
        let _ = writeln!(style, ".{name}{{{still}animation:{name} {seconds:.2}s step-end infinite}}");
        let _ = write!(style, "@keyframes {name}{{");
        if at > 0 {
            style.push_str("0%{visibility:hidden}");
        }
        let _ = write!(style, "{}%{{visibility:visible}}", percent(at));
        if end < 1000 {
            let _ = write!(style, "{}%{{visibility:hidden}}", percent(end));
        }
        style.push_str("}\n");
    }
    style.push_str("svg:hover *{animation-play-state:paused}\n");
    style.push_str("@media print,(prefers-reduced-motion:reduce){*{animation:none!important}}\n");
    Some(svg::moving(last, &style, &body))
}

fn class((from, to): (usize, usize)) -> String {
    format!("s{from}-{to}")
}

/// Tenths of a per cent.
fn percent(per_mille: u32) -> String {
    if per_mille.is_multiple_of(10) {
        format!("{}", per_mille / 10)
    } else {
        format!("{}.{}", per_mille / 10, per_mille % 10)
    }
}

/// The items of all scenes in an order that keeps that of each scene, equal ones of consecutive scenes as one.
fn merged(scenes: &[Scene]) -> Vec<Part<'_>> {
    let mut parts: Vec<Part> = Vec::new();
    for (number, scene) in scenes.iter().enumerate() {
        let mut next = 0;
        for item in &scene.items {
            let same = |part: &Part| part.to + 1 == number && part.item == item;
            match parts[next..].iter().position(same) {
                Some(ahead) => {
                    parts[next + ahead].to = number;
                    next += ahead + 1;
                }
                None => {
                    parts.insert(next, Part { item, from: number, to: number });
                    next += 1;
                }
            }
        }
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::palette::INK;
    use crate::scene::{Path, Stroke};

    fn scene(lines: &[f64]) -> Scene {
        let mut scene = Scene::new(20.0, 10.0);
        lines.iter().for_each(|y| scene.stroke(Path::polyline(&[[0.0, *y], [20.0, *y]]), Stroke::new(INK, 0.1)));
        scene
    }

    #[test]
    fn what_scenes_share_is_written_once() {
        // 1 is always seen, 2 in the first two scenes, 3 from the second on.
        let text = film(&[scene(&[1.0, 2.0]), scene(&[1.0, 2.0, 3.0]), scene(&[1.0, 3.0])], 1.0).unwrap();
        let times = |what: &str| text.matches(what).count();
        assert_eq!([times("M0 1h20"), times("M0 2h20"), times("M0 3h20")], [1, 1, 1], "{text}");
        // Five seconds: one for each of the first two scenes, three for the last one.
        assert!(text.contains(".s0-1{visibility:hidden;animation:s0-1 5.00s step-end infinite}"), "{text}");
        assert!(text.contains("@keyframes s0-1{0%{visibility:visible}40%{visibility:hidden}}"), "{text}");
        assert!(text.contains(".s1-2{animation:s1-2"), "{text}");
        assert!(text.contains("@keyframes s1-2{0%{visibility:hidden}20%{visibility:visible}}"), "{text}");
        assert!(text.contains("prefers-reduced-motion"), "{text}");
    }

    #[test]
    fn the_order_of_each_scene_stays() {
        let all = [scene(&[1.0, 4.0]), scene(&[1.0, 3.0, 4.0]), scene(&[2.0, 1.0, 4.0, 3.0])];
        let parts = merged(&all);
        for (number, scene) in all.iter().enumerate() {
            let seen: Vec<&Item> =
                parts.iter().filter(|part| (part.from..=part.to).contains(&number)).map(|part| part.item).collect();
            assert_eq!(seen, scene.items.iter().collect::<Vec<_>>(), "{number}");
        }
    }

    #[test]
    fn scenes_of_different_sizes_are_no_film() {
        assert_eq!(film(&[], 1.0), None);
        assert_eq!(film(&[scene(&[1.0]), Scene::new(30.0, 10.0)], 1.0), None);
    }
}
