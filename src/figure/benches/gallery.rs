//! Draws every figure from its sample data into a folder, as SVG, PNG (200 dpi) and PDF, with its CSV.
//!
//!     cargo bench --bench gallery -- FOLDER [NAME…]

#![allow(clippy::approx_constant, clippy::disallowed_methods)] // sample data, not mathematics

#[path = "../tests/figures/samples/mod.rs"]
mod samples;

use figure::{film::film, pdf::pdf, png::png, svg::svg, table::csv};
use std::path::PathBuf;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let Some((folder, names)) = words.split_first() else {
        return Ok(());
    };
    let folder = PathBuf::from(folder);
    std::fs::create_dir_all(&folder)?;
    println!("{:<28} {:>8} {:>8} {:>8} {:>9} {:>9} {:>9}", "figure", "draw", "svg", "png", "svg", "png", "pdf");
    for (name, style, figure) in samples::all() {
        if !names.is_empty() && !names.iter().any(|n| n == name) {
            continue;
        }
        let start = Instant::now();
        let scene = figure.scene(&style);
        let drawn = start.elapsed();
        let start = Instant::now();
        let vector = svg(&scene);
        let vector_time = start.elapsed();
        let start = Instant::now();
        let raster = png(&scene, 200.0)?;
        let raster_time = start.elapsed();
        let page = pdf(&scene);
        println!(
            "{name:<28} {:>5.1} ms {:>5.1} ms {:>5.0} ms {:>6} kB {:>6} kB {:>6} kB",
            drawn.as_secs_f64() * 1e3,
            vector_time.as_secs_f64() * 1e3,
            raster_time.as_secs_f64() * 1e3,
            vector.len() / 1000,
            raster.len() / 1000,
            page.len() / 1000
        );
        for fault in scene.faults() {
            println!("    {fault}");
        }
        std::fs::write(folder.join(format!("{name}.svg")), vector)?;
        std::fs::write(folder.join(format!("{name}.png")), raster)?;
        std::fs::write(folder.join(format!("{name}.pdf")), page)?;
        std::fs::write(folder.join(format!("{name}.csv")), csv(&figure.data()))?;
        if let Some(moving) = film(&figure.frames(&style), 0.12) {
            std::fs::write(folder.join(format!("{name}.moving.svg")), moving)?;
        }
    }
    Ok(())
}
