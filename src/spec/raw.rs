//! The link file key by key, as it is written; what is allowed together is decided elsewhere.

use std::fmt;

use serde::Deserialize as Derived;
use serde::de::{Deserialize, Deserializer, Error, Visitor};

use super::quantity::{Quantity, Real, Tapered, Unbounded};

/// The whole file.
#[derive(Debug, Derived)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct RawSpecification {
    pub(super) title: Option<String>,
    #[serde(default)]
    pub(super) segments: Vec<RawSegment>,
    #[serde(default)]
    pub(super) hub: RawHub,
    #[serde(default)]
    pub(super) masses: Vec<RawMass>,
    #[serde(default)]
    pub(super) payload: RawPayload,
    pub(super) damping: Option<RawDamping>,
    pub(super) drive: Option<RawDrive>,
    #[serde(default)]
    pub(super) limits: RawLimits,
    #[serde(default)]
    pub(super) mesh: RawMesh,
    #[serde(default)]
    pub(super) analysis: RawAnalysis,
}

/// `[[segments]]`
#[derive(Debug, Derived)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct RawSegment {
    pub(super) name: Option<String>,
    pub(super) length: Quantity,
    #[serde(rename = "EI")]
    pub(super) bending_stiffness: Option<Tapered>,
    #[serde(rename = "E")]
    pub(super) modulus: Option<Quantity>,
    #[serde(rename = "I")]
    pub(super) second_moment: Option<Tapered>,
    pub(super) mass_per_length: Option<Tapered>,
    pub(super) density: Option<Quantity>,
    pub(super) area: Option<Tapered>,
    pub(super) section: Option<RawSection>,
    pub(super) elements: Option<Count>,
}

/// `section = { … }`
#[derive(Debug, Derived)]
#[serde(deny_unknown_fields, expecting = "a table such as { shape = \"circle\", diameter = 0.01 }")]
pub(super) struct RawSection {
    pub(super) shape: String,
    pub(super) width: Option<Quantity>,
    pub(super) thickness: Option<Quantity>,
    pub(super) height: Option<Quantity>,
    pub(super) diameter: Option<Quantity>,
    pub(super) wall: Option<Quantity>,
}

/// `[hub]`
#[derive(Debug, Default, Derived)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub(super) struct RawHub {
    pub(super) inertia: Quantity,
    pub(super) radius: Quantity,
    pub(super) viscous_friction: Quantity,
}

/// `[[masses]]`
#[derive(Debug, Derived)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct RawMass {
    pub(super) at: Quantity,
    pub(super) mass: Quantity,
    #[serde(default)]
    pub(super) inertia: Quantity,
}

/// `[payload]`
#[derive(Debug, Default, Derived)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub(super) struct RawPayload {
    pub(super) mass: Quantity,
    pub(super) inertia: Quantity,
    pub(super) offset: Quantity,
}

/// `[damping]`
#[derive(Debug, Default, Derived)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub(super) struct RawDamping {
    pub(super) model: Option<String>,
    pub(super) ratio: Option<Real>,
    pub(super) ratios: Option<Vec<Real>>,
    pub(super) modes: Option<Vec<Count>>,
    pub(super) alpha: Option<Quantity>,
    pub(super) beta: Option<Quantity>,
}

/// `[drive]`
#[derive(Debug, Default, Derived)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub(super) struct RawDrive {
    pub(super) joint_stiffness: Option<Unbounded>,
    pub(super) rotor_inertia: Quantity,
    pub(super) gear_ratio: Option<Real>,
}

/// `[limits]`
#[derive(Debug, Default, Derived)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub(super) struct RawLimits {
    pub(super) torque: Option<Quantity>,
    pub(super) rms_torque: Option<Quantity>,
    pub(super) hub_rate: Option<Quantity>,
    pub(super) power: Option<Quantity>,
    pub(super) deflection: Option<Quantity>,
    pub(super) bending_moment: Option<Quantity>,
}

/// `[mesh]`
#[derive(Debug, Default, Derived)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub(super) struct RawMesh {
    pub(super) elements: Option<Elements>,
    pub(super) tolerance: Option<Real>,
}

/// `[analysis]`
#[derive(Debug, Default, Derived)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub(super) struct RawAnalysis {
    pub(super) tolerance: Option<Real>,
    pub(super) lead: Option<Quantity>,
    pub(super) lag: Option<Quantity>,
    pub(super) modes: Option<Count>,
}

/// A whole number of elements or modes, or that of a mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Count(pub(super) usize);

impl Count {
    const MOST: usize = 100_000;
}

/// Elements of the whole link.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Elements {
    /// `"auto"`
    Auto,
    /// A total.
    Total(Count),
}

/// Expects a count, or also the word `auto`.
struct CountVisitor {
    wanted: &'static str,
}

impl CountVisitor {
    fn count<E: Error>(&self, number: i64) -> Result<Count, E> {
        match usize::try_from(number) {
            Ok(count) if (1..=Count::MOST).contains(&count) => Ok(Count(count)),
            _ => Err(E::custom(format!("must be {}", self.wanted))),
        }
    }
}

impl Visitor<'_> for CountVisitor {
    type Value = Elements;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.wanted)
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<Elements, E> {
        self.count(number).map(Elements::Total)
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<Elements, E> {
        match word {
            "auto" => Ok(Elements::Auto),
            _ => Err(E::custom(format!("must be {}", self.wanted))),
        }
    }
}

const A_COUNT: &str = "a whole number from 1 to 100000";

impl<'de> Deserialize<'de> for Count {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match deserializer.deserialize_any(CountVisitor { wanted: A_COUNT })? {
            Elements::Total(count) => Ok(count),
            Elements::Auto => Err(D::Error::custom(format!("must be {A_COUNT}"))),
        }
    }
}

impl<'de> Deserialize<'de> for Elements {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(CountVisitor {
            wanted: "a whole number from 1 to 100000, or \"auto\"",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::tree::Node;
    use super::*;

    #[test]
    fn a_mesh_counts_its_elements_or_leaves_them_to_the_program() {
        let elements = |text: &str| {
            let tree = Node::document(text).unwrap();
            RawMesh::deserialize(&tree).map(|mesh| mesh.elements).ok()
        };
        let total = |count| Some(Some(Elements::Total(Count(count))));
        assert_eq!(elements("elements = 100000"), total(100_000));
        assert_eq!(elements("elements = 'auto'"), Some(Some(Elements::Auto)));
        assert_eq!(elements(""), Some(None));
        for text in ["elements = 100001", "elements = -1", "elements = 1.5", "elements = '5'"] {
            assert_eq!(elements(text), None, "{text}");
        }
    }
}
