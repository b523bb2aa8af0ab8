//! Free and locked joints of a problem.

use kinopt::model::ParameterMap;
use kinopt_bindings::parameters;

use crate::arguments::NamedArguments;
use crate::error::{Exception, raise};
use crate::model::Model;

/// Builds the map from `locked`, `only` and `held`; the default is that of the robot.
pub(crate) fn parameter_map(
    model: &Model,
    options: &NamedArguments,
) -> Result<Option<ParameterMap>, Exception> {
    if parameters::OPTIONS
        .iter()
        .all(|name| options.get(name).is_none())
    {
        return Ok(model.robot.as_ref().map(|robot| robot.map().clone()));
    }
    let builder = match &model.robot {
        Some(robot) => robot.parameters(),
        None => ParameterMap::builder(&model.inner),
    };
    let builder = parameters::apply(builder, &model.inner, options)?;
    builder.build().map(Some).map_err(raise)
}
