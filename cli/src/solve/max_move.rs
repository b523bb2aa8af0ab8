//! Largest displacement of joints from the start, in the general solver.

use kinopt_bindings::problem_file::number_list::Numbers;

use crate::failure::Outcome;
use crate::loaded_model::LoadedModel;

/// Largest displacement of every coordinate, in radians and metres, or `None` without the option.
///
/// # Errors
/// A wrong count of numbers; the message lists the coordinates.
pub(super) fn max_moves(
    loaded: &LoadedModel,
    given: Option<&Numbers>,
) -> Outcome<Option<Vec<f64>>> {
    let Some(Numbers { values, degrees }) = given else {
        return Ok(None);
    };
    let count = loaded.model.configuration_len();
    let by_coordinate = match values.as_slice() {
        [one] => vec![*one; count],
        by_coordinate if by_coordinate.len() == count => by_coordinate.to_vec(),
        by_coordinate => {
            return Err(usage!(
                "--max-move: {} numbers given; it takes one, or {count}: {}",
                by_coordinate.len(),
                loaded.coordinate_names().join(", ")
            ));
        }
    };
    // The displacement of a ball joint is its rotation angle, although its numbers are not angles.
    let turns = loaded.is_angle().zip(loaded.is_of_ball());
    let moves = by_coordinate.into_iter().zip(turns);
    let moves = moves.map(
        |(max_move, (angle, ball))| match *degrees && (angle || ball) {
            true => max_move.to_radians(),
            false => max_move,
        },
    );
    Ok(Some(moves.collect()))
}
