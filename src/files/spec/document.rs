//! Files of a link, and of an arm: a chain of links, each with the keys of a link file.

use std::collections::BTreeMap;

use serde::Deserialize;

use super::convert::{LinkKeys, limits, link_keys};
use super::error::{Fault, SpecError};
use super::overrides::{Override, apply};
use super::raw::{RawAnalysis, RawLimits, RawMesh, UNCERTAINTY};
use super::tree::{Kind, Node, Place};
use super::value::{AlongAxes, Angle, Axis, Mass, SlidingFriction, tables};
use crate::beam::MeshPlan;
use crate::inverse::Analysis;
use crate::link::{Arm, ArmCarriage, ArmLink, ArmParts, Carriage, Elbow, Joint, Link};
use crate::result::{JointQuantity, Limits, Remark};

/// Keys that an arm has once, for all its links.
pub(super) const SHARED: [&str; 2] = ["mesh", "analysis"];

/// Further keys of an arm that apply to its link if it has only one.
pub(super) const OF_ARM: [&str; 4] = ["title", "gravity", "start_angle", UNCERTAINTY];

/// The checked content of a file: one link, or an arm of several.
#[derive(Debug, Clone, PartialEq)]
pub struct Specification {
    /// The arm. A link is an arm of one link.
    pub arm: Arm,
    /// Mesh of each link.
    pub meshes: Vec<MeshPlan>,
    /// Tolerances, window and modes of the inversion.
    pub analysis: Analysis,
    /// Largest allowed values of each joint, its link and its motor.
    pub limits: Vec<Limits>,
    /// Possible but unusual values, often a slip of units.
    pub remarks: Vec<Remark>,
    /// Line of the file, from 1, at which each link of several begins; `None` if a `--set` wrote it.
    pub lines: Vec<Option<usize>>,
}

impl Specification {
    /// The first link; a link file has no other.
    pub fn link(&self) -> &Link {
        &self.arm.links()[0].link
    }

    /// The mesh of the first link.
    pub fn mesh(&self) -> &MeshPlan {
        &self.meshes[0]
    }
}

/// Keys of an arm file besides its links.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
struct RawArm {
    title: Option<String>,
    gravity: Option<AlongAxes>,
    #[serde(rename = "start_angle")]
    _start_angle: Option<Angle>,
    elbow: Option<Elbow>,
    carriage: Option<RawArmCarriage>,
    limits: Option<RawLimits>,
    #[serde(deserialize_with = "tables")]
    links: Vec<RawArmLink>,
    #[serde(rename = "uncertainty")]
    _uncertainty: BTreeMap<String, String>,
    #[serde(rename = "mesh")]
    _mesh: RawMesh,
    #[serde(rename = "analysis")]
    _analysis: RawAnalysis,
}

/// `[carriage]` of an arm, on which its first joint stands.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
struct RawArmCarriage {
    mass: Mass,
    viscous_friction: SlidingFriction,
    axis: Option<Axis>,
}

/// Keys of an arm's link besides those of a link file.
#[derive(Debug, Deserialize)]
struct RawArmLink {
    name: Option<String>,
}

/// Reads the text of a file of a link or an arm, and applies the `overrides` in their order.
///
/// Errors call the file `name`.
///
/// # Errors
/// [`SpecError`] names the line, or the `--set`, and the wrong value.
pub fn read_specification(
    name: &str,
    text: &str,
    overrides: &[Override],
) -> Result<Specification, SpecError> {
    LinkDocument::read(name, text)?.specification(name, overrides)
}

/// The text of a link file, parsed once for many sets of overrides, but not checked yet.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkDocument {
    pub(super) tree: Node,
}

impl LinkDocument {
    /// Parses the text of a link file; errors call the file `name`.
    ///
    /// # Errors
    /// [`SpecError`] names the line that is no TOML.
    pub fn read(name: &str, text: &str) -> Result<Self, SpecError> {
        Ok(Self { tree: Node::document(name, text)? })
    }

    /// The content of the file with the `overrides` applied in their order.
    ///
    /// # Errors
    /// Those of [`read_specification`].
    pub fn specification(
        &self,
        name: &str,
        overrides: &[Override],
    ) -> Result<Specification, SpecError> {
        let tree = self.changed(overrides)?;
        let mut read =
            specification_of(&tree).map_err(|fault| located(fault, &tree, (name, overrides)))?;
        // A multiplied value keeps the unit of the value before, so that only the latter is judged.
        if overrides.iter().any(Override::is_factor) {
            let given: Vec<_> =
                overrides.iter().filter(|change| !change.is_factor()).cloned().collect();
            let before = self.changed(&given).ok().and_then(|tree| specification_of(&tree).ok());
            read.remarks = before.map_or(read.remarks, |before| before.remarks);
        }
        Ok(read)
    }

    /// The file as a tree, with the changes applied in their order.
    pub(super) fn changed(&self, overrides: &[Override]) -> Result<Node, SpecError> {
        let mut tree = self.tree.clone();
        for (number, change) in overrides.iter().enumerate() {
            apply(&mut tree, number, change)?;
        }
        Ok(tree)
    }
}

/// Name of a place in errors.
pub(super) fn shown(place: Place, name: &str, overrides: &[Override]) -> String {
    match place {
        Place::File => name.to_owned(),
        Place::Line(line) => format!("{name}:{line}"),
        Place::Override(number) => overrides[number].place.clone(),
    }
}

/// Makes the error for the last of its places in a tree, which the `overrides` changed.
pub(super) fn located(
    fault: Fault,
    tree: &Node,
    (name, overrides): (&str, &[Override]),
) -> SpecError {
    let place = fault.paths.iter().map(|path| tree.place_of(path)).max();
    fault.at(shown(place.unwrap_or(Place::File), name, overrides))
}

/// Reads a link or an arm from a tree.
pub(super) fn specification_of(tree: &Node) -> Result<Specification, Fault> {
    if tree.get("links").is_none() {
        return link_keys(tree).map(of_one_link);
    }
    if tree.get("carriage").is_some_and(|own| own.get("root_stiffness").is_some()) {
        let message = "is for one link: the first joint of an arm stands on the carriage";
        return Err(Fault::on("carriage.root_stiffness", message));
    }
    let raw = RawArm::deserialize(tree)?;
    let count = raw.links.len();
    if count == 0 {
        return Err(Fault::new("links", "links is empty, but must hold at least one [[links]]"));
    }
    // Messages name a link like a `--set`: by its name, or by its number.
    let called = |link: usize| raw.links[link].name.clone().unwrap_or_else(|| link.to_string());
    let read = |link: usize| {
        let node = link_node(tree, (link, &called(link)), count)?;
        link_keys(&node).map_err(|fault| fault.of_link((link, &called(link)), link + 1 == count))
    };
    if count == 1 {
        if raw.elbow.is_some() {
            return Err(Fault::new("elbow", "elbow has no meaning for an arm of one link"));
        }
        let given = [("carriage", raw.carriage.is_some()), ("limits", raw.limits.is_some())];
        if let Some((key, _)) = given.iter().find(|(_, is_given)| *is_given) {
            let message = "has no meaning above one link: it is a key of the link";
            return Err(Fault::on(*key, message));
        }
        return read(0).map(of_one_link);
    }
    if tree.get("start_angle").is_some() {
        let message = "start_angle has no meaning for an arm of several links, which starts where its path starts";
        return Err(Fault::new("start_angle", message));
    }
    let each = (0..count).map(read).collect::<Result<Vec<_>, _>>()?;
    let lines = (0..count).map(|link| line_of(tree, link)).collect();
    let names = raw.links.into_iter().map(|link| link.name);
    let analysis = each[0].analysis;
    let (mut links, mut meshes) = (Vec::new(), Vec::new());
    let (mut all_limits, mut remarks) = (Vec::new(), Vec::new());
    for (own, name) in each.into_iter().zip(names) {
        links.push(ArmLink { name, link: own.link });
        meshes.push(own.mesh);
        all_limits.push(own.limits);
        remarks.extend(own.remarks);
    }
    let carriage = raw.carriage.as_ref().map(carriage);
    match (carriage, raw.limits) {
        (Some(own), of_carriage) => all_limits.push(carriage_limits(own, of_carriage)?),
        (None, Some(_)) => {
            let message = "are keys of each link: above the links only [carriage] has limits";
            return Err(Fault::new("limits", format!("limits {message}")));
        }
        (None, None) => {}
    }
    let arm = Arm::new(ArmParts {
        title: raw.title.unwrap_or_default(),
        links,
        gravity_m_s2: raw.gravity.map_or([0.0; 2], |AlongAxes(gravity)| gravity),
        elbow: raw.elbow,
        carriage,
    })?;
    Ok(Specification { arm, meshes, analysis, limits: all_limits, remarks, lines })
}

/// The carriage of an arm.
fn carriage(raw: &RawArmCarriage) -> ArmCarriage {
    let (mass_kg, viscous_friction_n_s_m) = (raw.mass.si(), raw.viscous_friction.si());
    let carriage = Carriage { mass_kg, viscous_friction_n_s_m };
    ArmCarriage { carriage, axis: raw.axis.map_or([1.0, 0.0], |Axis(axis)| axis) }
}

/// Limits of the carriage of an arm.
fn carriage_limits(own: ArmCarriage, raw: Option<RawLimits>) -> Result<Limits, Fault> {
    let raw = raw.unwrap_or_default();
    let is_of_link =
        |key: &str| JointQuantity::of_limit(key).is_some_and(JointQuantity::is_of_link);
    if let Some((key, _)) = raw.0.iter().find(|(key, _)| is_of_link(key)) {
        let message = "is a limit of a link: set it in [[links]]";
        return Err(Fault::on(format!("limits.{key}"), message));
    }
    limits(&raw, &Joint::Prismatic(own.carriage), None)
}

/// A link is an arm of one link.
fn of_one_link(LinkKeys { link, mesh, analysis, limits, remarks }: LinkKeys) -> Specification {
    let (meshes, limits, lines) = (vec![mesh], vec![limits], vec![None]);
    Specification { arm: Arm::from(link), meshes, analysis, limits, remarks, lines }
}

/// Line of the file at which a link begins.
fn line_of(tree: &Node, link: usize) -> Option<usize> {
    match tree.get("links")?.get(&link.to_string())?.place {
        Place::Line(line) => Some(line),
        Place::File | Place::Override(_) => None,
    }
}

/// Makes a link of an arm the tree of a link file.
fn link_node(tree: &Node, (link, called): (usize, &str), count: usize) -> Result<Node, Fault> {
    let list = tree.get("links").and_then(|node| node.get(&link.to_string()));
    let Some(Node { place, kind: Kind::Table(own) }) = list else {
        return Err(Fault::new(format!("links.{link}"), "must be a table"));
    };
    let shared = SHARED.iter().chain(OF_ARM.iter().filter(|_| count == 1));
    let mut entries: Vec<(String, Node)> = Vec::new();
    for key in shared {
        entries.extend(tree.get(key).map(|node| ((*key).to_owned(), node.clone())));
    }
    let is_last = link + 1 == count;
    for (key, node) in own {
        let refused = |why: &str| {
            let message = format!("links.{called}.{key} {why}");
            Err(Fault::new(format!("links.{link}.{key}"), message))
        };
        match key.as_str() {
            "name" => {}
            key if SHARED.contains(&key) || OF_ARM.contains(&key) => {
                return refused("belongs to the whole arm, above its links");
            }
            "payload" if !is_last => {
                return refused(
                    "has no meaning: only the last link has a payload; `tip` is the body of a joint",
                );
            }
            "tip" if is_last => {
                return refused("has no meaning: the body on the last link is its `payload`");
            }
            "tip" => entries.push(("payload".to_owned(), node.clone())),
            _ => entries.push((key.clone(), node.clone())),
        }
    }
    Ok(Node { place: *place, kind: Kind::Table(entries) })
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINK: &str = "segments = [{ length = 0.5, EI = 20, mass_per_length = 0.3 }]";

    fn read(text: &str) -> Result<Specification, String> {
        read_specification("arm.toml", text, &[]).map_err(|error| error.to_string())
    }

    #[test]
    fn an_arm_of_one_link_is_that_link() {
        let gravity = "title = 'one'\ngravity = [0, -9.81]\nstart_angle = 0.3\n";
        let hub = "hub = { inertia = 0.1 }\npayload = { mass = '50 g' }\nmesh.elements = 12\n";
        let plain = read(&format!("{gravity}{hub}{LINK}")).unwrap();
        let hub = "hub = { inertia = 0.1 }\npayload = { mass = '50 g' }\n";
        let arm = format!("{gravity}mesh.elements = 12\n[[links]]\nname = 'only'\n{hub}{LINK}");
        assert_eq!(read(&arm).unwrap(), plain);
    }

    #[test]
    fn links_have_their_own_keys_and_the_arm_has_the_others_once() {
        let inner =
            format!("[[links]]\nname = 'upper'\ntip = {{ mass = 1, inertia = 0.01 }}\n{LINK}\n");
        let outer = format!("[[links]]\npayload = {{ mass = 0.1 }}\n{LINK}\n");
        let top = "gravity = [0, '-9.81 m/s^2']\nelbow = 'right'\nmesh.elements = 6\n";
        let Specification { arm, meshes, .. } = read(&format!("{top}{inner}{outer}")).unwrap();
        assert_eq!((arm.elbow(), arm.gravity_m_s2()), (Some(Elbow::Right), [0.0, -9.81]));
        assert_eq!((arm.name_of(0), arm.name_of(1)), ("link upper".into(), "link 2".into()));
        let carried = [0, 1].map(|link: usize| arm.links()[link].link.payload().mass_kg);
        assert!((carried[0] - 1.0).abs() < 1e-15 && (carried[1] - 0.1).abs() < 1e-15);
        assert!(meshes.iter().all(|mesh| !mesh.is_automatic()));
    }

    #[test]
    fn what_is_wrong_in_a_link_is_placed_there() {
        let with = |more: &str| format!("[[links]]\n{LINK}\n[[links]]\n{more}\n{LINK}");
        let refused = |more: &str| read(&with(more)).unwrap_err();
        let negative = refused("hub = { inertia = -1 }");
        let message =
            "arm.toml:4: links.1.hub.inertia = -1 kg m^2, but must be finite and at least 0";
        assert_eq!(negative, message);
        assert!(refused("hubb = 1").starts_with("arm.toml:4: unknown key `hubb` in links.1"));
        assert!(refused("gravity = [0, 0]").contains("links.1.gravity belongs to"));
        assert!(refused("tip = { mass = 1 }").contains("`payload`"));
        assert!(read("links = 3").unwrap_err().contains("must be tables headed [[links]]"));
        let twice = format!("[[links]]\nname = 'a'\n{LINK}\n[[links]]\nname = 'a'\n{LINK}");
        assert!(read(&twice).unwrap_err().starts_with("arm.toml:5: links.1.name = \"a\""));
    }

    #[test]
    fn a_mesh_tolerance_has_its_range() {
        let refused = |tolerance: &str| {
            let segment = "{ length = 1, EI = 1, mass_per_length = 1 }";
            let text = format!("segments = [{segment}]\nmesh.tolerance = {tolerance}");
            read_specification("link.toml", &text, &[]).is_err()
        };
        assert!(!refused("1e-12") && !refused("0.1"));
        assert!(refused("0.9e-12") && refused("0.11"));
    }

    #[test]
    fn an_error_is_placed_in_the_file_the_line_or_the_setting() {
        let place = |text: &str, set: &str| {
            let error = read_specification("link.toml", text, &[set.parse().unwrap()]);
            let message = error.unwrap_err().to_string();
            message.split_once(": ").unwrap().0.to_owned()
        };
        assert_eq!(place("", "hub.inertia=1"), "link.toml");
        assert_eq!(place("\n\nlimits = 1", "hub.inertia=1"), "link.toml:3");
        assert_eq!(place("", "hub.x=1"), "--set 'hub.x=1'");
    }
}
