//! The film of the README: an arm among obstacles, a humanoid that reaches, and a robot that moves like a captured
//! person.

mod arm_panel;
mod capture_panel;
mod crouch_panel;
mod gif_file;
mod palette;
mod panel;
mod person_mesh;
mod robot_mesh;
mod shape_mesh;

use std::num::NonZero;
use std::path::Path;
use std::thread;

use crate::Failure;
use panel::Panel;

/// Number of frames of one loop.
const FRAMES: usize = 90;
const FRAMES_PER_SECOND: usize = 15;
/// Width and height of each panel, pixels.
const PANEL: [usize; 2] = [300, 300];

/// Renders all panels and writes the film to `path`. `root` is the folder of the repository.
pub(crate) fn film(root: &Path, path: &Path) -> Result<(), Failure> {
    let panels = [
        arm_panel::panel(root)?,
        crouch_panel::panel(root)?,
        capture_panel::panel(root)?,
    ];
    let frames = render_all(&panels)?;
    let size = [PANEL[0] * panels.len(), PANEL[1]];
    gif_file::write(path, size, &frames, FRAMES_PER_SECOND)
}

/// Returns the pixels of all frames, with the panels next to each other.
fn render_all(panels: &[Panel]) -> Result<Vec<Vec<[u8; 3]>>, Failure> {
    let threads = thread::available_parallelism().map_or(1, NonZero::get);
    let render_every = |first: usize| -> Vec<_> {
        let frames = (first..FRAMES).step_by(threads);
        frames.map(|frame| side_by_side(panels, frame)).collect()
    };
    let mut frames = vec![Vec::new(); FRAMES];
    thread::scope(|scope| {
        let renderers: Vec<_> = (0..threads)
            .map(|first| scope.spawn(move || render_every(first)))
            .collect();
        for (first, renderer) in renderers.into_iter().enumerate() {
            let rendered = renderer.join().map_err(|_| "a thread panicked")?;
            for (frame, pixels) in frames.iter_mut().skip(first).step_by(threads).zip(rendered) {
                *frame = pixels;
            }
        }
        Ok(frames)
    })
}

/// Returns the pixels of one frame, row by row through all panels.
fn side_by_side(panels: &[Panel], frame: usize) -> Vec<[u8; 3]> {
    let images = panels.iter().map(|panel| panel.render(frame, PANEL).rgb());
    let images: Vec<Vec<[u8; 3]>> = images.collect();
    let rows = (0..PANEL[1]).flat_map(|y| {
        let row = y * PANEL[0]..(y + 1) * PANEL[0];
        images.iter().map(move |image| &image[row.clone()])
    });
    rows.flatten().copied().collect()
}
