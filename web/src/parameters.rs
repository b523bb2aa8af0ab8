//! Free and locked joints of a problem.

use kinopt::model::ParameterMap;
use kinopt_bindings::parameters;

use crate::arguments::{self, NamedArguments};
use crate::error::{Exception, raise};
use crate::model::Model;
use crate::value::Value;

/// Builds the map from `locked`, `only` and `held`; the default is that of the robot.
pub(crate) fn parameters(
    model: &Model,
    options: &NamedArguments,
) -> Result<Option<ParameterMap>, Exception> {
    let (only, held) = (options.texts("only")?, options.numbers("held")?);
    let locked = arguments::entries(options.get("locked").as_ref(), "locked")?;
    if locked.is_empty() && only.is_none() && held.is_none() {
        return Ok(model.robot.as_ref().map(|robot| robot.map().clone()));
    }
    let inner_model = &model.inner;
    let mut builder = match &model.robot {
        Some(robot) => robot.parameters(),
        None => ParameterMap::builder(inner_model),
    };
    let locked = locked.into_iter();
    let locked = locked.map(|(name, value)| (name, Value(value)));
    let what = |name: &str| format!("locked.{name}");
    builder = parameters::lock(builder, inner_model, locked.collect(), what)?;
    builder = parameters::only::<Value>(builder, inner_model, only.as_deref(), ("held", held))?;
    builder.build().map(Some).map_err(raise)
}
