//! Greedy set cover of cells by balls (Chvátal 1979).

use std::collections::BinaryHeap;

use super::candidates::grown;
use super::cells::Cell;
use super::solid::Solid;
use crate::collision::Ball;
use kinopt_kinematics::interruption::is_stopped;

/// The chosen balls, with the cells assigned to each.
#[derive(Debug, Default)]
pub(super) struct Cover {
    pub(super) balls: Vec<Ball>,
    pub(super) cells: Vec<Vec<Cell>>,
}

/// Covers cells by candidate balls. A cell that no candidate contains gets an additional ball. That ball contains the
/// cell, as cells are finer than the allowed protrusion.
pub(super) fn cover(
    solid: &Solid<'_>,
    surface: Vec<Cell>,
    inner: Vec<Cell>,
    candidates: &[Ball],
    max_protrusion: f64,
) -> Cover {
    let mut chosen = greedy(&surface, candidates);
    for cell in &surface {
        if is_stopped() {
            return Cover::default();
        }
        if !is_covered(&chosen, cell) {
            chosen.push(grown(solid, cell.anchor, max_protrusion));
        }
    }
    let mut cells = surface;
    let mut pending = inner;
    while let Some(cell) = pending.pop() {
        if is_stopped() {
            return Cover::default();
        }
        // A large cell may be covered by several balls that each contain a part.
        if is_covered(&chosen, &cell) {
            cells.push(cell);
        } else if cell.half > max_protrusion / 4.0 {
            pending.extend(cell.split(solid));
        } else {
            chosen.push(grown(solid, cell.centre, max_protrusion));
            cells.push(cell);
        }
    }
    assign(chosen, cells)
}

pub(super) fn is_covered(balls: &[Ball], cell: &Cell) -> bool {
    balls.iter().any(|ball| cell.is_in(ball))
}

fn greedy(cells: &[Cell], candidates: &[Ball]) -> Vec<Ball> {
    let contained = |ball: &Ball| -> Vec<u32> {
        if is_stopped() {
            return Vec::new();
        }
        let holds = |(index, cell): (usize, &Cell)| cell.is_in(ball).then_some(index as u32);
        cells.iter().enumerate().filter_map(holds).collect()
    };
    let contained: Vec<Vec<u32>> = candidates.iter().map(contained).collect();
    let mut covered = vec![false; cells.len()];
    // The gain of a ball never increases, so an old value is an upper bound. Ties go to the first candidate.
    let first = contained.iter().enumerate();
    let mut heap: BinaryHeap<(usize, std::cmp::Reverse<usize>)> = first
        .map(|(k, contained)| (contained.len(), std::cmp::Reverse(k)))
        .collect();
    let mut chosen = Vec::new();
    while let Some((bound, std::cmp::Reverse(k))) = heap.pop() {
        let gain = contained[k]
            .iter()
            .filter(|cell| !covered[**cell as usize])
            .count();
        if gain == 0 {
            continue;
        }
        if gain < bound
            && heap
                .peek()
                .is_some_and(|(next_bound, _)| *next_bound > gain)
        {
            heap.push((gain, std::cmp::Reverse(k)));
            continue;
        }
        contained[k]
            .iter()
            .for_each(|cell| covered[*cell as usize] = true);
        chosen.push(k);
    }
    // Drops balls that later ones made redundant.
    let mut cover_counts = vec![0_u32; cells.len()];
    for &k in &chosen {
        contained[k]
            .iter()
            .for_each(|cell| cover_counts[*cell as usize] += 1);
    }
    chosen.retain(|&k| {
        let needed = contained[k]
            .iter()
            .any(|cell| cover_counts[*cell as usize] == 1);
        if !needed {
            contained[k]
                .iter()
                .for_each(|cell| cover_counts[*cell as usize] -= 1);
        }
        needed
    });
    chosen.into_iter().map(|k| candidates[k]).collect()
}

/// Assigns each cell to the ball that contains it with the least increase of the ball's required radius.
fn assign(balls: Vec<Ball>, mut cells: Vec<Cell>) -> Cover {
    let cover_count = |cell: &Cell| {
        if is_stopped() {
            return 0;
        }
        let contains = |ball: &&Ball| cell.is_in(ball);
        balls.iter().filter(contains).count()
    };
    // Cells with the fewest choices first.
    cells.sort_by_cached_key(cover_count);
    let mut needed = vec![0.0_f64; balls.len()];
    let mut assigned: Vec<Vec<Cell>> = vec![Vec::new(); balls.len()];
    for cell in cells {
        if is_stopped() {
            return Cover::default();
        }
        let mut best: Option<(f64, usize, f64)> = None;
        for (k, ball) in balls.iter().enumerate() {
            if !cell.is_in(ball) {
                continue;
            }
            let required = cell.required_radius(ball.centre);
            let increase = (required - needed[k]).max(0.0);
            if best.is_none_or(|(min_increase, ..)| increase < min_increase) {
                best = Some((increase, k, required));
            }
        }
        if let Some((_, k, required)) = best {
            needed[k] = needed[k].max(required);
            assigned[k].push(cell);
        }
    }
    let used = balls
        .into_iter()
        .zip(assigned)
        .filter(|(_, assigned)| !assigned.is_empty());
    let (balls, cells) = used.unzip();
    Cover { balls, cells }
}
