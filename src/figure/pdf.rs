//! Scene → PDF of one page: text stays text (embedded fonts, searchable), streams compressed, no dates, fixed ids.

use super::font::{FACES, Face};
use super::scene::{Color, Fill, Item, Path, Point, Scene, Step, Stroke};
use super::text::{Line, POINT};
use math::elementary::sin_cos;
use pdf_writer::types::{CidFontType, FontFlags, LineCapStyle, LineJoinStyle, SystemInfo, UnicodeCmap};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, Str, TextStr};
use std::collections::{BTreeMap, BTreeSet};

const IDENTITY: SystemInfo = SystemInfo { registry: Str(b"Adobe"), ordering: Str(b"Identity"), supplement: 0 };

/// The picture as a PDF file.
pub fn pdf(scene: &Scene) -> Vec<u8> {
    let scale = (1.0 / POINT) as f32;
    let mut page = Page { content: Content::new(), used: BTreeMap::new(), opacities: BTreeSet::new() };
    page.content.transform([scale, 0.0, 0.0, -scale, 0.0, scene.height as f32 * scale]);
    page.content.set_line_cap(LineCapStyle::RoundCap).set_line_join(LineJoinStyle::RoundJoin);
    for item in &scene.items {
        page.item(item);
    }
    let mut ids = Ref::new(1);
    let mut pdf = Pdf::new();
    let (catalog, pages, sheet, content) = (ids.bump(), ids.bump(), ids.bump(), ids.bump());
    pdf.catalog(catalog).pages(pages);
    pdf.document_info(ids.bump()).title(TextStr(&scene.title)).subject(TextStr(&scene.description));
    pdf.pages(pages).kids([sheet]).count(1);
    let fonts: Vec<(Face, Ref)> =
        FACES.into_iter().filter(|f| page.used.contains_key(f)).map(|f| (f, ids.bump())).collect();
    let states: Vec<(i32, Ref)> = page.opacities.iter().map(|&o| (o, ids.bump())).collect();
    {
        let mut out = pdf.page(sheet);
        let size = [scene.width as f32 * scale, scene.height as f32 * scale];
        out.parent(pages).media_box(Rect::new(0.0, 0.0, size[0], size[1])).contents(content);
        let mut resources = out.resources();
        let mut names = resources.fonts();
        for &(face, id) in &fonts {
            names.pair(Name(&font_name(face)), id);
        }
        names.finish();
        let mut names = resources.ext_g_states();
        for &(opacity, id) in &states {
            names.pair(Name(format!("O{opacity}").as_bytes()), id);
        }
    }
    for (opacity, id) in states {
        let alpha = opacity as f32 / 1000.0;
        pdf.ext_graphics(id).non_stroking_alpha(alpha).stroking_alpha(alpha);
    }
    stream(&mut pdf, content, &page.content.finish());
    for (face, id) in fonts {
        let used = page.used.get(&face).cloned().unwrap_or_default();
        embed(&mut pdf, face, id, &used, &mut ids);
    }
    pdf.finish()
}

fn stream(pdf: &mut Pdf, id: Ref, data: &[u8]) {
    let packed = miniz_oxide::deflate::compress_to_vec_zlib(data, 8);
    pdf.stream(id, &packed).filter(Filter::FlateDecode);
}

fn font_name(face: Face) -> [u8; 2] {
    [b'F', face.letter() as u8]
}

/// Writes a face as a CID font; glyph numbers are its codes.
fn embed(pdf: &mut Pdf, face: Face, id: Ref, used: &BTreeMap<u16, char>, ids: &mut Ref) {
    let (child, descriptor, file, cmap) = (ids.bump(), ids.bump(), ids.bump(), ids.bump());
    let label = match face {
        Face::Regular => "FlowFigureSans-Regular",
        Face::Italic => "FlowFigureSans-Italic",
        Face::Semibold => "FlowFigureSans-Semibold",
    };
    let base = Name(label.as_bytes());
    pdf.type0_font(id).base_font(base).encoding_predefined(Name(b"Identity-H")).descendant_font(child).to_unicode(cmap);
    let mut font = pdf.cid_font(child);
    font.subtype(CidFontType::Type2).base_font(base).system_info(IDENTITY).font_descriptor(descriptor);
    font.default_width(0.0).cid_to_gid_map_predefined(Name(b"Identity"));
    let mut widths = font.widths();
    for &glyph in used.keys() {
        widths.consecutive(glyph, [1000.0 * face.advance(glyph) as f32]);
    }
    widths.finish();
    font.finish();
    let tables = face.tables();
    let bounds = tables.global_bounding_box();
    let slant = if face == Face::Italic { FontFlags::ITALIC } else { FontFlags::empty() };
    pdf.font_descriptor(descriptor)
        .name(base)
        .flags(FontFlags::SYMBOLIC | slant)
        .bbox(Rect::new(bounds.x_min.into(), bounds.y_min.into(), bounds.x_max.into(), bounds.y_max.into()))
        .italic_angle(tables.italic_angle())
        .ascent(tables.ascender().into())
        .descent(tables.descender().into())
        .cap_height(660.0)
        .stem_v(if face == Face::Semibold { 120.0 } else { 84.0 })
        .font_file2(file);
    let mut map = UnicodeCmap::<u16>::new(Name(b"Flow-UCS"), IDENTITY);
    for (&glyph, &c) in used {
        map.pair(glyph, c);
    }
    let map = map.finish();
    stream(pdf, cmap, &map);
    stream(pdf, file, face.file());
}

struct Page {
    content: Content,
    /// Glyphs that the page uses of each face.
    used: BTreeMap<Face, BTreeMap<u16, char>>,
    /// Opacities that the page uses, in thousandths.
    opacities: BTreeSet<i32>,
}

impl Page {
    fn item(&mut self, item: &Item) {
        match item {
            Item::Shape { path, fill, stroke } => self.shape(path, fill.as_ref(), stroke.as_ref()),
            Item::Discs { discs, color } => self.discs(discs, *color),
            Item::Text { line, at, angle, color } => self.text(line, *at, *angle, *color),
            Item::Group { clip, items, .. } => {
                self.content.save_state();
                if let Some(r) = clip {
                    self.content.rect(r.left as f32, r.top as f32, r.width() as f32, r.height() as f32);
                    self.content.clip_nonzero().end_path();
                }
                for item in items {
                    self.item(item);
                }
                self.content.restore_state();
            }
        }
    }

    fn shape(&mut self, path: &Path, fill: Option<&Fill>, stroke: Option<&Stroke>) {
        if path.0.is_empty() {
            return;
        }
        if let Some(fill) = fill {
            self.opacity(fill.opacity);
            self.fill_color(fill.color);
            self.trace(path);
            self.content.fill_even_odd();
        }
        if let Some(stroke) = stroke {
            self.opacity(stroke.opacity);
            self.stroke_color(stroke.color);
            self.content.set_line_width(stroke.width as f32);
            self.content.set_dash_pattern(stroke.dash.iter().map(|&d| d as f32), 0.0);
            self.trace(path);
            self.content.stroke();
        }
    }

    /// Zero-length lines with round ends.
    fn discs(&mut self, discs: &[(Point, f64)], color: Color) {
        self.opacity(1.0);
        self.stroke_color(color);
        self.content.set_dash_pattern([], 0.0);
        let mut last = -1.0;
        let mut sorted: Vec<&(Point, f64)> = discs.iter().collect();
        sorted.sort_by(|a, b| a.1.total_cmp(&b.1));
        for &&([x, y], r) in &sorted {
            let width = (2.0 * r * 100.0).round() / 100.0;
            if width != last {
                self.content.set_line_width(width as f32);
                last = width;
            }
            let (x, y) = (((x * 100.0).round() / 100.0) as f32, ((y * 100.0).round() / 100.0) as f32);
            self.content.move_to(x, y).line_to(x, y).stroke();
        }
    }

    fn text(&mut self, line: &Line, at: Point, angle: f64, color: Color) {
        self.opacity(1.0);
        self.fill_color(color);
        let (s, c) = sin_cos(angle.to_radians());
        let place = |x: f64, y: f64| [at[0] + x * c + y * s, at[1] - x * s + y * c];
        self.content.begin_text();
        for g in &line.glyphs {
            let [x, y] = place(g.at[0], g.at[1]);
            self.content.set_font(Name(&font_name(g.face)), g.size as f32);
            self.content.set_text_matrix([c as f32, -s as f32, -s as f32, -c as f32, x as f32, y as f32]);
            self.content.show(Str(&g.id.to_be_bytes()));
            self.used.entry(g.face).or_default().insert(g.id, g.character);
        }
        self.content.end_text();
        for r in &line.rules {
            let corners = [[r.left, r.top], [r.right, r.top], [r.right, r.bottom], [r.left, r.bottom]];
            self.trace(&Path::polygon(&corners.map(|[x, y]| place(x, y))));
            self.content.fill_nonzero();
        }
    }

    fn trace(&mut self, path: &Path) {
        let f = |p: Point| (p[0] as f32, p[1] as f32);
        for step in &path.0 {
            match *step {
                Step::Move(p) => self.content.move_to(f(p).0, f(p).1),
                Step::Line(p) => self.content.line_to(f(p).0, f(p).1),
                Step::Cubic(a, b, p) => self.content.cubic_to(f(a).0, f(a).1, f(b).0, f(b).1, f(p).0, f(p).1),
                Step::Close => self.content.close_path(),
            };
        }
    }

    fn opacity(&mut self, opacity: f64) {
        let thousandths = (opacity * 1000.0).round() as i32;
        self.opacities.insert(thousandths);
        self.content.set_parameters(Name(format!("O{thousandths}").as_bytes()));
    }

    fn fill_color(&mut self, Color(r, g, b): Color) {
        let [r, g, b] = [r, g, b].map(|c| f32::from(c) / 255.0);
        self.content.set_fill_rgb(r, g, b);
    }

    fn stroke_color(&mut self, Color(r, g, b): Color) {
        let [r, g, b] = [r, g, b].map(|c| f32::from(c) / 255.0);
        self.content.set_stroke_rgb(r, g, b);
    }
}
