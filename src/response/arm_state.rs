//! Where an arm is and how it moves at one instant, from which another play goes on.

use serde::{Deserialize, Serialize};

use super::error::SimulationError;
use super::state::State;
use crate::link::Arm;

/// The motion of an arm at one instant.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ArmState {
    /// The state of each link, the inner one first: slopes against x along it.
    pub links: Vec<State>,
}

impl ArmState {
    /// Refuses a state that is not one of such an arm.
    ///
    /// # Errors
    /// [`SimulationError::State`].
    pub(super) fn check(&self, arm: &Arm) -> Result<(), SimulationError> {
        let (found, links) = (self.links.len(), arm.links().len());
        if found != links {
            let must = format!("be one of {links} links");
            return Err(SimulationError::State { found: format!("that of {found} links"), must });
        }
        let time_s = self.links[0].time_s;
        if let Some(other) = self.links.iter().find(|own| own.time_s.total_cmp(&time_s).is_ne()) {
            let found = format!("at {} s and at {time_s} s", other.time_s);
            let must = "be that of one instant".to_owned();
            return Err(SimulationError::State { found, must });
        }
        for (number, (state, own)) in self.links.iter().zip(arm.links()).enumerate() {
            state.check(&own.link, true).map_err(|error| match error {
                SimulationError::State { found, must } => {
                    let found = format!("{found} on {}", arm.name_of(number));
                    SimulationError::State { found, must }
                }
                other => other,
            })?;
        }
        Ok(())
    }
}
