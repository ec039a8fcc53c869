//! Scene → PNG by `tiny-skia`: white ground, resolution written in the file.

use super::font::UNITS_PER_EM;
use super::scene::{Color, Item, Path, Point, Rect, Scene, Step, Stroke};
use super::text::Line;
use math::elementary::sin_cos;
use tiny_skia::{FillRule, LineCap, LineJoin, Mask, Paint, PathBuilder, Pixmap, StrokeDash, Transform};

/// Why a picture could not be drawn.
#[derive(Debug, thiserror::Error)]
pub enum PngError {
    /// The page has no area or too many pixels.
    #[error("a page of {width:.1} mm × {height:.1} mm at {dpi} dpi has no drawable size (1 to 20,000 pixels a side)")]
    Size {
        /// Page width in mm.
        width: f64,
        /// Page height in mm.
        height: f64,
        /// Dots per inch.
        dpi: f64,
    },
}

/// The picture as a PNG file at `dpi` dots per inch.
pub fn png(scene: &Scene, dpi: f64) -> Result<Vec<u8>, PngError> {
    let scale = dpi / 25.4;
    let size = |mm: f64| (mm * scale).round();
    let fits = |mm: f64| (1.0..=20_000.0).contains(&size(mm));
    let fault = || PngError::Size { width: scene.width, height: scene.height, dpi };
    if !fits(scene.width) || !fits(scene.height) {
        return Err(fault());
    }
    let mut map = Pixmap::new(size(scene.width) as u32, size(scene.height) as u32).ok_or_else(fault)?;
    map.fill(tiny_skia::Color::WHITE);
    let mut canvas = Canvas { map, scale: scale as f32, mask: None };
    for item in &scene.items {
        canvas.item(item);
    }
    Ok(encode(&canvas.map, dpi))
}

/// Eight-bit RGB. Each row is stored as it is or as the difference to the row above, whichever has the smaller sum; the
/// compressor is one portable implementation, so the bytes do not depend on the processor.
fn encode(map: &Pixmap, dpi: f64) -> Vec<u8> {
    let (width, height) = (map.width(), map.height());
    let rgb: Vec<u8> = map.data().chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
    let stride = 3 * width as usize;
    let mut filtered = Vec::with_capacity(rgb.len() + height as usize);
    let mut above = vec![0_u8; stride];
    for row in rgb.chunks_exact(stride) {
        let up: Vec<u8> = row.iter().zip(&above).map(|(a, b)| a.wrapping_sub(*b)).collect();
        let cost = |r: &[u8]| r.windows(2).filter(|w| w[0] != w[1]).count();
        let (kind, best) = if cost(&up) < cost(row) { (2, &up[..]) } else { (0, row) };
        filtered.push(kind);
        filtered.extend_from_slice(best);
        above.copy_from_slice(row);
    }
    let per_metre = ((dpi / 0.0254).round() as u32).to_be_bytes();
    let mut out = b"\x89PNG\r\n\x1a\n".to_vec();
    chunk(&mut out, b"IHDR", &[&width.to_be_bytes()[..], &height.to_be_bytes()[..], &[8, 2, 0, 0, 0]].concat());
    chunk(&mut out, b"pHYs", &[&per_metre[..], &per_metre[..], &[1]].concat());
    chunk(&mut out, b"IDAT", &miniz_oxide::deflate::compress_to_vec_zlib(&filtered, 8));
    chunk(&mut out, b"IEND", &[]);
    out
}

/// Length, name, data and checksum.
fn chunk(out: &mut Vec<u8>, name: &[u8; 4], data: &[u8]) {
    out.extend_from_slice(&(data.len() as u32).to_be_bytes());
    let from = out.len();
    out.extend_from_slice(name);
    out.extend_from_slice(data);
    let sum = crc32fast::hash(&out[from..]);
    out.extend_from_slice(&sum.to_be_bytes());
}

struct Canvas {
    map: Pixmap,
    scale: f32,
    mask: Option<Mask>,
}

impl Canvas {
    fn item(&mut self, item: &Item) {
        match item {
            Item::Shape { path, fill, stroke } => {
                let Some(path) = outline(path) else { return };
                if let Some(fill) = fill {
                    self.fill(&path, fill.color, fill.opacity, FillRule::EvenOdd, self.page());
                }
                if let Some(stroke) = stroke {
                    self.stroke(&path, stroke);
                }
            }
            Item::Discs { discs, color } => {
                for &([x, y], r) in discs {
                    if let Some(circle) = PathBuilder::from_circle(x as f32, y as f32, r as f32) {
                        self.fill(&circle, *color, 1.0, FillRule::Winding, self.page());
                    }
                }
            }
            Item::Text { line, at, angle, color } => self.text(line, *at, *angle, *color),
            Item::Group { clip, items, .. } => {
                let outer = self.mask.clone();
                if let Some(clip) = clip {
                    self.clip(*clip);
                }
                for item in items {
                    self.item(item);
                }
                self.mask = outer;
            }
        }
    }

    fn page(&self) -> Transform {
        Transform::from_scale(self.scale, self.scale)
    }

    fn clip(&mut self, clip: Rect) {
        let Some(path) = outline(&Path::rect(clip)) else { return };
        let page = self.page();
        match &mut self.mask {
            Some(mask) => mask.intersect_path(&path, FillRule::Winding, true, page),
            None => {
                self.mask = Mask::new(self.map.width(), self.map.height());
                if let Some(mask) = &mut self.mask {
                    mask.fill_path(&path, FillRule::Winding, true, page);
                }
            }
        }
    }

    fn fill(&mut self, path: &tiny_skia::Path, color: Color, opacity: f64, rule: FillRule, transform: Transform) {
        self.map.fill_path(path, &paint(color, opacity), rule, transform, self.mask.as_ref());
    }

    fn stroke(&mut self, path: &tiny_skia::Path, stroke: &Stroke) {
        let dash: Vec<f32> = stroke.dash.iter().map(|&d| d as f32).collect();
        let style = tiny_skia::Stroke {
            width: stroke.width as f32,
            line_cap: LineCap::Round,
            line_join: LineJoin::Round,
            dash: if dash.is_empty() { None } else { StrokeDash::new(dash, 0.0) },
            ..tiny_skia::Stroke::default()
        };
        let page = self.page();
        self.map.stroke_path(path, &paint(stroke.color, stroke.opacity), &style, page, self.mask.as_ref());
    }

    fn text(&mut self, line: &Line, at: Point, angle: f64, color: Color) {
        let (s, c) = sin_cos(angle.to_radians());
        let (s, c) = (s as f32, c as f32);
        let turned = Transform::from_row(c, -s, s, c, at[0] as f32, at[1] as f32).post_concat(self.page());
        for g in &line.glyphs {
            let mut builder = Outline(PathBuilder::new());
            g.face.outline(g.id, &mut builder);
            let Some(path) = builder.0.finish() else { continue };
            let k = (g.size / UNITS_PER_EM) as f32;
            let place = Transform::from_row(k, 0.0, 0.0, -k, g.at[0] as f32, g.at[1] as f32).post_concat(turned);
            self.fill(&path, color, 1.0, FillRule::Winding, place);
        }
        for &rule in &line.rules {
            if let Some(path) = outline(&Path::rect(rule)) {
                self.fill(&path, color, 1.0, FillRule::Winding, turned);
            }
        }
    }
}

fn paint(Color(r, g, b): Color, opacity: f64) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(r, g, b, (opacity * 255.0).round() as u8);
    paint
}

/// Draws cubic arcs as quadratic ones: the library's stroke of a cubic calls the system's cosine, which differs between
/// machines.
fn outline(path: &Path) -> Option<tiny_skia::Path> {
    let mut out = PathBuilder::new();
    let f = |p: Point| (p[0] as f32, p[1] as f32);
    let mut at = [0.0; 2];
    for step in &path.0 {
        match *step {
            Step::Move(p) => out.move_to(f(p).0, f(p).1),
            Step::Line(p) => out.line_to(f(p).0, f(p).1),
            Step::Cubic(a, b, p) => {
                for [control, end] in quadratics([at, a, b, p]) {
                    out.quad_to(f(control).0, f(control).1, f(end).0, f(end).1);
                }
            }
            Step::Close => out.close(),
        }
        if let Step::Move(p) | Step::Line(p) | Step::Cubic(_, _, p) = *step {
            at = p;
        }
    }
    out.finish()
}

/// A cubic arc as four quadratic ones, each with the ends and nearly the tangents of its part; a quarter of a circle is
/// off by less than 10⁻⁴ of its radius.
fn quadratics([mut from, mut a, mut b, to]: [Point; 4]) -> [[Point; 2]; 4] {
    let mix = |p: Point, q: Point, t: f64| [p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])];
    std::array::from_fn(|i| {
        // Cuts off the first of the parts that are left (de Casteljau).
        let t = 1.0 / (4 - i) as f64;
        let [left, middle, right] = [mix(from, a, t), mix(a, b, t), mix(b, to, t)];
        let [inner, outer] = [mix(left, middle, t), mix(middle, right, t)];
        let end = if i == 3 { to } else { mix(inner, outer, t) };
        let control = |k: usize| 0.25 * (3.0 * (left[k] + inner[k]) - from[k] - end[k]);
        let arc = [[control(0), control(1)], end];
        (from, a, b) = (end, outer, right);
        arc
    })
}

struct Outline(PathBuilder);

impl ttf_parser::OutlineBuilder for Outline {
    fn move_to(&mut self, x: f32, y: f32) {
        self.0.move_to(x, y);
    }
    fn line_to(&mut self, x: f32, y: f32) {
        self.0.line_to(x, y);
    }
    fn quad_to(&mut self, a: f32, b: f32, x: f32, y: f32) {
        self.0.quad_to(a, b, x, y);
    }
    fn curve_to(&mut self, a: f32, b: f32, c: f32, d: f32, x: f32, y: f32) {
        self.0.cubic_to(a, b, c, d, x, y);
    }
    fn close(&mut self) {
        self.0.close();
    }
}
