//! A link or an arm, and its file or keywords.

use flexlink::cli::options::inputs::specification;
use flexlink::cli::terminal::console;
use flexlink::csv::{InputFile, Joints};
use flexlink::link::Link as OneLink;
use flexlink::response::{ModeChoice, StateSpaceScope};
use flexlink::spec::{LinkDocument, Override, Specification, changed_text};

use crate::arrays::OneOrEach;
use crate::keywords;
use crate::prelude::*;
use crate::properties::check;
use crate::state_space::StateSpace;

/// Name of keywords in errors.
const KEYWORDS: &str = "keywords";

/// The text that describes a link or an arm, and its changes.
#[derive(Debug, Clone)]
pub(crate) struct Source {
    pub(crate) file: InputFile,
    /// True for a file, false for keywords, because a run keeps no record of keywords.
    pub(crate) is_file: bool,
    /// As `--set` reads them.
    pub(crate) changes: Vec<String>,
}

/// A text that describes a link or an arm in a pickle.
pub(crate) type PickledSource = (String, String, Vec<u8>, bool, Vec<String>);

impl Source {
    fn read(path: &Path, changes: Vec<String>) -> Fails<Self> {
        Ok(Self { file: InputFile::read_toml(path)?, is_file: true, changes })
    }

    fn of_keywords(keys: &Bound<'_, PyDict>) -> PyResult<Self> {
        let (shown, name) = (KEYWORDS.to_owned(), KEYWORDS.to_owned());
        let file = InputFile { shown, name, bytes: keywords::document(keys)?.into_bytes() };
        Ok(Self { file, is_file: false, changes: Vec::new() })
    }

    /// The source with further changes.
    pub(crate) fn changed(&self, more: Vec<String>) -> Self {
        let changes = self.changes.iter().cloned().chain(more).collect();
        Self { changes, ..self.clone() }
    }

    /// The changes, followed by those of a case.
    pub(crate) fn overrides(&self, more: &[String]) -> Fails<Vec<Override>> {
        let read = |change: &String| {
            change.parse().map_err(|error: flexlink::spec::SpecError| usage(&error, error.hint()))
        };
        self.changes.iter().chain(more).map(read).collect()
    }

    pub(crate) fn document(&self) -> Fails<LinkDocument> {
        Ok(LinkDocument::read(&self.file.shown, self.file.text()?)?)
    }

    pub(crate) fn described(&self) -> Fails<Specification> {
        let read = specification(&self.file, &self.overrides(&[])?);
        read.map_err(|failure| if self.is_file { failure } else { without_line(failure) })
    }

    /// The text of the file with the changes; that of keywords is new.
    fn text(&self) -> Fails<String> {
        let (name, text) = (&self.file.shown, self.file.text()?);
        Ok(changed_text(name, text, &self.overrides(&[])?, !self.is_file)?)
    }

    /// The arguments for `unpickled`.
    pub(crate) fn pickled(&self) -> PickledSource {
        let InputFile { shown, name, bytes } = self.file.clone();
        (shown, name, bytes, self.is_file, self.changes.clone())
    }

    fn unpickled((shown, name, bytes, is_file, changes): PickledSource) -> Self {
        Self { file: InputFile { shown, name, bytes }, is_file, changes }
    }
}

/// A message on keywords without the number of their line.
pub(crate) fn without_line(failure: Failure) -> Failure {
    let message = failure.message.strip_prefix(KEYWORDS).and_then(|rest| {
        let (line, message) = rest.strip_prefix(':')?.split_once(": ")?;
        line.parse::<u64>().ok().map(|_| message.to_owned())
    });
    Failure { message: message.unwrap_or(failure.message), ..failure }
}

/// A flexible link with its hub, payload and damping, or an arm of several, as a file describes it (`flexlink help
/// files`).
///
/// From a file by :meth:`Link.read`, or from keywords that are the keys of such a file. Numbers are SI, texts have units.
/// ``carriage={"mass": 800}`` in place of ``hub`` makes a link on a carriage, which a force moves.
/// ``flexlink.Arm`` is another name of this class: a link is an arm of one link.
///
/// >>> import flexlink
/// >>> link = flexlink.Link(
/// ...     title="strip",
/// ...     segments=[{"length": "1.5 m", "EI": 5.0, "mass_per_length": 0.8}],
/// ...     hub={"inertia": 0.1},
/// ...     damping={"ratio": 0.02},
/// ... )
/// >>> link
/// Link('strip', length=1.5)
/// >>> stiff = link.changed({"segments.*.EI*": 4, "payload.mass": "50 g"})
/// >>> round(stiff.rigid_inertia - link.rigid_inertia, 9)  # 0.05 kg at 1.5 m
/// 0.1125
/// >>> stiff.values["payload"], flexlink.Link(**stiff.values).rigid_inertia == stiff.rigid_inertia
/// ({'mass': '50 g'}, True)
#[pyclass(frozen, module = "flexlink")]
pub(crate) struct Link {
    pub(crate) source: Source,
    pub(crate) specification: Specification,
}

impl Link {
    fn of(source: Source) -> Fails<Self> {
        Ok(Self { specification: source.described()?, source })
    }

    pub(crate) fn unpickled(source: PickledSource) -> Fails<Self> {
        Self::of(Source::unpickled(source))
    }

    /// The joints.
    pub(crate) fn kind(&self) -> Joints {
        Joints::from(&self.specification.arm)
    }

    /// Number of links.
    pub(crate) fn links(&self) -> usize {
        self.kind().links
    }

    /// The first link.
    pub(crate) fn first(&self) -> &OneLink {
        &self.specification.arm.links()[0].link
    }

    /// The link of an arm of one.
    pub(crate) fn one(&self) -> Option<&OneLink> {
        (self.links() == 1).then(|| self.first())
    }
}

#[pymethods]
impl Link {
    #[new]
    #[pyo3(signature = (**keys))]
    fn new(py: Python<'_>, keys: Option<Keywords<'_>>) -> Raises<Self> {
        let keys = keys.unwrap_or_else(|| PyDict::new(py));
        Ok(Self::of(Source::of_keywords(&keys)?)?)
    }

    /// Reads a file of a link or an arm, with changes as those of ``--set``: ``{"payload.mass": 0.2, "segments.*.EI*": 4}``
    /// or ``{"links.fore.payload.mass": 0.2}``; a key that ends in ``*`` multiplies the value of the file.
    #[staticmethod]
    #[pyo3(signature = (path, changes=None))]
    fn read(path: PathBuf, changes: Option<&Bound<'_, PyDict>>) -> Raises<Self> {
        Ok(Self::of(Source::read(&path, keywords::changes(changes)?)?)?)
    }

    /// The same link with further changes.
    fn changed(&self, changes: &Bound<'_, PyDict>) -> Raises<Self> {
        Ok(Self::of(self.source.changed(keywords::changes(Some(changes))?))?)
    }

    /// The keys of the file with the changes, as nested dictionaries: numbers in SI, texts with their units.
    /// ``Link(**link.values)`` is the same link.
    #[getter]
    fn values<'py>(&self, py: Python<'py>) -> Raises<Any<'py>> {
        let values = self.source.document()?.values(&self.source.overrides(&[])?);
        Ok(loaded(py, &values.map_err(Failure::from)?)?)
    }

    /// The text of the link file with the changes.
    #[getter]
    fn text(&self) -> Raises<String> {
        Ok(self.source.text()?)
    }

    /// Writes the link file with the changes; :meth:`Link.read` reads the same link. Comments of the file stay, unless a
    /// change adds or removes a key.
    fn write(&self, py: Python<'_>, path: PathBuf) -> Raises<()> {
        let text = self.source.text()?;
        Ok(py.detach(|| console::deliver(Some(&path), text.as_bytes()))?)
    }

    /// Title of the file.
    #[getter]
    fn title(&self) -> &str {
        self.specification.arm.title()
    }

    /// Distance of the tip of one link from the axis, or from the carriage, in m.
    #[getter]
    fn length(&self) -> PyResult<f64> {
        check("length", self.kind())?;
        Ok(self.first().length_m())
    }

    /// Lengths of the links in m, the inner one first.
    #[getter]
    fn lengths(&self) -> Vec<f64> {
        self.specification.arm.lengths_m()
    }

    /// Inertia about the axis in kg m² of one rigid link.
    #[getter]
    fn rigid_inertia(&self) -> PyResult<f64> {
        check("rigid_inertia", self.kind())?;
        Ok(self.first().rigid_inertia_kg_m2())
    }

    /// Mass in kg of one link with its carriage.
    #[getter]
    fn rigid_mass(&self) -> PyResult<f64> {
        check("rigid_mass", self.kind())?;
        Ok(self.first().rigid_inertia_kg_m2())
    }

    /// Small motions in state space, for the design of controllers: modes with free joints, from the torque of each joint, or
    /// the force on a carriage, to joints, tip and strain at the root.
    ///
    /// ``modes`` is a number of modes beyond the rigid link, or the swings of an arm, or a list of the numbers of single modes.
    /// ``at`` has the directions of the links in rad, with their weight; an arm needs them. The displacements at
    /// ``stations``, distances in m from the joint of each link, are further outputs. With ``residual`` D has the static
    /// response of the modes left out.
    ///
    /// >>> import flexlink
    /// >>> link = flexlink.Link(
    /// ...     segments=[{"length": 1.0, "EI": 10.0, "mass_per_length": 0.5}], hub={"inertia": 0.1}
    /// ... )
    /// >>> space = link.state_space(modes=2)
    /// >>> space
    /// StateSpace(states=6, inputs=1, outputs=6)
    /// >>> A, B, C, D = space
    /// >>> space.states[:3], space.outputs[2]
    /// (['mode_0', 'mode_1', 'mode_2'], 'tip_displacement')
    /// >>> bool(abs(C[0, 0] * B[3, 0] * link.rigid_inertia - 1) < 1e-9)  # slowly it turns as if it were rigid
    /// True
    #[pyo3(signature = (modes=OneOrEach::One(5), *, at=None, stations=Vec::new(), residual=false))]
    #[pyo3(text_signature = "($self, modes=5, *, at=None, stations=(), residual=False)")]
    fn state_space(
        &self,
        py: Python<'_>,
        modes: OneOrEach<usize>,
        at: Option<OneOrEach<f64>>,
        stations: Vec<f64>,
        residual: bool,
    ) -> Raises<StateSpace> {
        let modes = match modes {
            OneOrEach::One(count) => ModeChoice::First(count),
            OneOrEach::Each(numbers) => ModeChoice::Numbers(numbers),
        };
        let scope = StateSpaceScope { modes, stations_m: stations, has_residual: residual };
        StateSpace::of(py, &self.specification, at, &scope)
    }

    fn __repr__(&self) -> String {
        let title = self.title().replace('\\', "\\\\").replace('\'', "\\'");
        match &self.lengths()[..] {
            [length] => format!("Link('{title}', length={length:?})"),
            lengths => format!("Arm('{title}', lengths={lengths:?})"),
        }
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> Reduced<'py> {
        let unpickle = slf.get_type().getattr("_unpickled")?;
        Ok((unpickle, slf.get().source.pickled().into_pyobject(slf.py())?))
    }

    #[staticmethod]
    #[pyo3(signature = (*source))]
    fn _unpickled(source: &Bound<'_, PyTuple>) -> Raises<Self> {
        Ok(Self::unpickled(source.extract()?)?)
    }
}
