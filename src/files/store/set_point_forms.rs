//! Forms of a file with set-points: a C header, a MATLAB script, arrays, a message of ROS 2, lines for `LinuxCNC`.

use std::io::{self, Write};

use super::arrays::{NamedArray, Values, mat, npz};
use super::set_point_file::{SetPointFile, ShownColumn, in_name};
use crate::csv::{NumberFormat, sha256, time_format};
use crate::response::Interpolation;
use crate::result::SetPoint;
use crate::text::plain;

/// Signs before, between and after the numbers of a row.
type Signs = [&'static str; 3];

const C_NUMBER: Signs = ["    ", "", ",\n"];
const C_ROW: Signs = ["    {", ", ", "},\n"];
const BLANKS: Signs = ["", " ", "\n"];

/// Fields of a point of a message with their numbers; seconds and nanoseconds from the start.
type Point = (Vec<(&'static str, Vec<String>)>, [i64; 2]);

/// Longest comment in bytes that halstreamer skips as one line.
const HAL_LINE: usize = 3900;

/// Columns of one unit that stand side by side.
struct Section<'a> {
    /// End of its name.
    name: String,
    /// Its content.
    comment: String,
    columns: Vec<&'a ShownColumn<'a>>,
}

impl Section<'_> {
    fn unit(&self) -> &str {
        &self.columns[0].column.unit.label
    }

    fn rows(&self, signs: Signs) -> Vec<u8> {
        let columns = self.columns.iter().map(|own| (&own.numbers[..], own.format));
        rows(&columns.collect::<Vec<_>>(), signs)
    }

    fn is_whole(&self) -> bool {
        self.columns.iter().all(|own| own.column.unit.is_count)
    }
}

impl SetPointFile<'_> {
    /// The columns of each quantity, together where they have one unit.
    fn sections<'a>(&self, shown: &'a [ShownColumn<'a>]) -> Vec<Section<'a>> {
        let mut all = Vec::new();
        for set_point in self.table.set_points() {
            let columns = shown.iter().filter(|own| own.column.set_point == set_point);
            let columns: Vec<_> = columns.collect();
            let (first, word) = (columns[0].column, set_point.word());
            if self.is_plain {
                let name = in_name(set_point.si_unit(first.slides));
                all.push(Section { name, comment: self.what(), columns });
                continue;
            }
            let section = |number: String, columns: Vec<&'a ShownColumn<'a>>| {
                let own = columns[0].column;
                Section {
                    name: format!("{word}{number}_{}", in_name(&own.unit.label)),
                    comment: own.unit.described(set_point, own.slides),
                    columns,
                }
            };
            let is_same = columns
                .iter()
                .all(|own| own.column.unit == first.unit && own.column.slides == first.slides);
            if is_same {
                all.push(section(String::new(), columns));
            } else {
                let alone = columns.into_iter();
                all.extend(alone.map(|own| section((own.column.joint + 1).to_string(), vec![own])));
            }
        }
        all
    }

    /// The C header.
    pub(super) fn c(&self, stem: &str) -> Vec<u8> {
        let line = |line: String| {
            let line = line.replace("*/", "* /").replace("/*", "/ *").replace("??", "? ?");
            format!(" * {line}\n")
        };
        let shown = self.shown();
        let sections = self.sections(&shown);
        let comment: String = self.comment().into_iter().map(line).collect();
        let (macros, grid) = (stem.to_ascii_uppercase(), self.table.grid());
        let (length, step) = (grid.len, floating(grid.step_s));
        let joints = match sections.iter().map(|own| own.columns.len()).max() {
            Some(joints) if joints > 1 => format!("#define {macros}_JOINTS {joints}\n"),
            _ => String::new(),
        };
        let begins = if self.is_plain {
            String::new()
        } else {
            format!("#define {macros}_MOTION_BEGINS_S {}\n", floating(self.begins().time_s))
        };
        let head = format!(
            "#define {macros}_LENGTH {length}\n{joints}#define {macros}_STEP_S {step}\n{begins}\n\
             /* Time in s */\nstatic const double {stem}_time_s[{macros}_LENGTH] = {{\n"
        );
        let mut body = [head.as_bytes(), &self.times(C_NUMBER)].concat();
        for section in &sections {
            let (kind, name) =
                (if section.is_whole() { "int32_t" } else { "double" }, &section.name);
            let (columns, signs) = match section.columns.len() {
                1 => (String::new(), C_NUMBER),
                _ => (format!("[{macros}_JOINTS]"), C_ROW),
            };
            let begin = format!(
                "}};\n\n/* {} */\nstatic const {kind} {stem}_{name}[{macros}_LENGTH]{columns} = {{\n",
                section.comment
            );
            body.extend([begin.as_bytes(), &section.rows(signs)].concat());
        }
        body.extend(b"};\n");
        // A compiler refuses the second of two tables of one name; a guard of the name alone would omit it.
        let guard = format!("{macros}_H_{}", &sha256(&body)[..16].to_ascii_uppercase());
        let has_counts = sections.iter().any(Section::is_whole);
        let include = if has_counts { "#include <stdint.h>\n\n" } else { "" };
        let begin = format!("/*\n{comment} */\n#ifndef {guard}\n#define {guard}\n\n{include}");
        [begin.as_bytes(), &body, b"\n#endif\n"].concat()
    }

    /// The MATLAB script. Octave, which lacks `timeseries`, runs it up to that line.
    pub(super) fn matlab(&self, stem: &str) -> Vec<u8> {
        let line = |line: String| format!("% {line}\n");
        let shown = self.shown();
        let sections = self.sections(&shown);
        let comment: String = self.comment().into_iter().map(line).collect();
        let step = plain(self.table.grid().step_s);
        let begins = if self.is_plain {
            String::new()
        } else {
            format!("{stem}_motion_begins_s = {};\n", plain(self.begins().time_s))
        };
        let head = format!("{comment}{stem}_step_s = {step};\n{begins}{stem}_time_s = [\n");
        let mut script = [head.as_bytes(), &self.times(BLANKS)].concat();
        for section in &sections {
            script.extend(format!("];\n{stem}_{} = [\n", section.name).bytes());
            script.extend(section.rows(BLANKS));
        }
        script.extend(b"];\n");
        let is_held = self.table.interpolation() == Interpolation::Zero;
        let method = if is_held { "zoh" } else { "linear" };
        for section in &sections {
            let (name, unit) = (&section.name, section.unit());
            let series = if self.is_plain { stem.to_owned() } else { format!("{stem}_{name}") };
            let tail = format!(
                "{series}_series = timeseries({stem}_{name}, {stem}_time_s, 'Name', '{series}');\n\
                 {series}_series.TimeInfo.Units = 'seconds';\n{series}_series.DataInfo.Units = '{unit}';\n\
                 {series}_series = setinterpmethod({series}_series, '{method}');\n"
            );
            script.extend(tail.bytes());
        }
        script
    }

    /// NumPy's archive of arrays.
    pub(super) fn write_npz(&self, out: &mut (dyn Write + Send)) -> io::Result<()> {
        self.with_arrays(|_, arrays| npz(arrays, out))
    }

    /// MATLAB's file of arrays.
    pub(super) fn write_mat(&self, out: &mut (dyn Write + Send)) -> io::Result<()> {
        self.with_arrays(|about, arrays| mat(about, arrays, out))
    }

    /// Gives the first line of the comment, and all arrays: time, step, columns, and their description.
    fn with_arrays(
        &self,
        write: impl FnOnce(&str, &[NamedArray<'_>]) -> io::Result<()>,
    ) -> io::Result<()> {
        let shown = self.shown();
        let grid = self.table.grid();
        let times_s: Vec<f64> = (0..grid.len).map(|k| grid.time_s(k)).collect();
        let named_by_quantity = SetPointFile { is_plain: false, ..*self };
        let sections = named_by_quantity.sections(&shown).into_iter().map(|own| {
            let by_column = own.columns.iter().flat_map(|column| column.numbers.iter().copied());
            let by_column: Vec<f64> = by_column.collect();
            (own.name, own.columns.len(), by_column)
        });
        let sections: Vec<_> = sections.collect();
        let comment = self.comment();
        let about = comment.join("\n");
        let names: Vec<&str> = self.joint_names.iter().map(String::as_str).collect();
        let named = |name, values| NamedArray { name, values };
        let mut arrays = vec![
            named("time_s", Values::Vector(&times_s)),
            named("step_s", Values::Number(grid.step_s)),
            named("motion_begins_s", Values::Number(self.begins().time_s)),
        ];
        arrays.extend(sections.iter().map(|(name, columns, by_column)| {
            let values = match columns {
                1 => Values::Vector(by_column),
                _ => Values::Matrix { rows: grid.len, columns: *columns, by_column },
            };
            named(name, values)
        }));
        arrays.push(named("joint_names", Values::Texts(&names)));
        arrays.push(named("about", Values::Text(&about)));
        write(comment.first().map_or("", String::as_str), &arrays)
    }

    /// The message `trajectory_msgs/JointTrajectory` in YAML.
    pub(super) fn ros_yaml(&self) -> Vec<u8> {
        let line = |line: String| format!("# {line}\n");
        let begins = self.begins().to_string();
        let comment: String = [begins].into_iter().chain(self.comment()).map(line).collect();
        let names = self.joint_names.iter().map(|name| format!("'{}'", name.replace('\'', "''")));
        let names = names.collect::<Vec<_>>().join(", ");
        let head = format!(
            "{comment}header:\n  stamp: {{sec: 0, nanosec: 0}}\n  frame_id: ''\njoint_names: [{names}]\npoints:\n"
        );
        let points = self.points().into_iter().map(|(lists, [sec, nanosec])| {
            let lists = lists.iter().map(|(name, numbers)| {
                let numbers: Vec<String> = numbers.iter().map(|own| yaml_float(own)).collect();
                format!("{name}: [{}]\n  ", numbers.join(", "))
            });
            let lists: String = lists.collect();
            format!("- {lists}time_from_start: {{sec: {sec}, nanosec: {nanosec}}}\n")
        });
        (head + &points.collect::<String>()).into_bytes()
    }

    /// The message `trajectory_msgs/JointTrajectory` in JSON.
    pub(super) fn ros_json(&self) -> Vec<u8> {
        let names: Vec<String> = self
            .joint_names
            .iter()
            .map(|name| serde_json::Value::from(&name[..]).to_string())
            .collect();
        let points = self.points().into_iter().map(|(lists, [sec, nanosec])| {
            let lists = lists
                .iter()
                .map(|(name, numbers)| format!("\"{name}\": [{}], ", numbers.join(", ")));
            let lists: String = lists.collect();
            format!(
                "    {{{lists}\"time_from_start\": {{\"sec\": {sec}, \"nanosec\": {nanosec}}}}}"
            )
        });
        let points = points.collect::<Vec<_>>().join(",\n");
        let names = names.join(", ");
        format!(
            "{{\n  \"header\": {{\"stamp\": {{\"sec\": 0, \"nanosec\": 0}}, \"frame_id\": \"\"}},\n  \
             \"joint_names\": [{names}],\n  \"points\": [\n{points}\n  ]\n}}\n"
        )
        .into_bytes()
    }

    /// The points of the message: the numbers of each field, and seconds and nanoseconds from the start.
    fn points(&self) -> Vec<Point> {
        let shown = self.shown();
        let grid = self.table.grid();
        let fields = [
            ("positions", SetPoint::Position),
            ("velocities", SetPoint::Velocity),
            ("accelerations", SetPoint::Acceleration),
            ("effort", SetPoint::Effort),
        ];
        let point = |k: usize| {
            let lists = fields.map(|(name, set_point)| {
                let own = shown.iter().filter(|own| own.column.set_point == set_point);
                let numbers = own.map(|own| {
                    let mut text = Vec::new();
                    own.format.write(&mut text, own.numbers[k]);
                    String::from_utf8_lossy(&text).into_owned()
                });
                (name, numbers.collect())
            });
            #[expect(clippy::cast_possible_truncation, reason = "times are far below 2^53 ns")]
            let nanoseconds = (grid.time_s(k) * 1e9).round() as i64;
            let second = 1_000_000_000;
            (lists.into(), [nanoseconds.div_euclid(second), nanoseconds.rem_euclid(second)])
        };
        (0..grid.len).map(point).collect()
    }

    /// Lines for halstreamer: the numbers of a cycle with blanks between; it skips comments.
    pub(super) fn halstreamer(&self) -> Vec<u8> {
        let shown = self.shown();
        let pins = shown.iter().map(|own| if own.column.unit.is_count { 's' } else { 'f' });
        let pins = format!("loadrt streamer depth=16000 cfg={}", pins.collect::<String>());
        let columns: Vec<&str> = shown.iter().map(|own| own.heading.as_str()).collect();
        let columns = format!("pins: {}", columns.join(", "));
        let step = format!("a line each {} s", plain(self.table.grid().step_s));
        let lines = [self.begins().to_string()].into_iter().chain(self.comment());
        let mut text = Vec::new();
        for line in lines.chain([step, columns, pins]) {
            let end = line.char_indices().map(|(at, _)| at).take_while(|at| *at < HAL_LINE).last();
            let end = if line.len() <= HAL_LINE { line.len() } else { end.unwrap_or(0) };
            text.extend(format!("# {}\n", &line[..end]).bytes());
        }
        let columns: Vec<_> = shown.iter().map(|own| (&own.numbers[..], own.format)).collect();
        text.extend(rows(&columns, BLANKS));
        text
    }

    /// A row for each time in s.
    fn times(&self, signs: Signs) -> Vec<u8> {
        let grid = self.table.grid();
        let times_s: Vec<f64> = (0..grid.len).map(|k| grid.time_s(k)).collect();
        rows(&[(&times_s, time_format(|k| times_s[k], grid.len))], signs)
    }
}

/// Columns with their formats as rows of numbers.
fn rows(columns: &[(&[f64], NumberFormat)], [before, between, after]: Signs) -> Vec<u8> {
    let mut text = Vec::new();
    for k in 0..columns[0].0.len() {
        text.extend(before.bytes());
        for (place, (column, format)) in columns.iter().enumerate() {
            text.extend(if place > 0 { between } else { "" }.bytes());
            format.write(&mut text, column[k]);
        }
        text.extend(after.bytes());
    }
    text
}

/// A number in the form of a C floating-point number.
fn floating(value: f64) -> String {
    let text = plain(value);
    if text.contains(['.', 'e']) { text } else { text + ".0" }
}

/// A number that every version of YAML reads as one: with a point, also before an exponent.
fn yaml_float(number: &str) -> String {
    match number.split_once('e') {
        _ if number.contains('.') => number.to_owned(),
        Some((digits, exponent)) => format!("{digits}.0e{exponent}"),
        None => format!("{number}.0"),
    }
}
