//! Assignment of columns to quantities.

use super::format::{ColumnName, Reading, TableFormat};
use super::heading::{
    HUB_ANGLE, HUB_RATE, Heading, NamedColumn, Quantity, Spelling, TIME, Vocabulary, find, names,
    nearest, refuse_missing, unread_unit,
};
use super::input::{Place, TableError, quoted};
use super::unit_name::{split_any_unit, split_unit};

/// The columns that a reader uses, found from the first row.
pub(super) struct Columns {
    /// Headings from the left.
    pub(super) headings: Vec<Heading>,
    pub(super) first: FirstRow,
    /// True if a heading is neither standard nor chosen.
    pub(super) is_guessed: bool,
    /// Columns without a quantity, from 0; empty if the user chose the columns.
    pub(super) unread: Vec<usize>,
    /// Deviations of the columns from the standard form.
    pub(super) reading: Reading,
}

/// Content of a table's first row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FirstRow {
    Names,
    Samples,
}

/// Quantities that may have a common name besides a quantity with its standard word.
pub(super) enum Beside {
    /// Only the time: the quantities of a table are one motion.
    Time,
    /// Only the time, beside a column that is already known.
    Column(Heading),
    /// All: each quantity is a separate channel. The search continues besides chosen columns.
    Others,
}

/// The first row of a table, its place, and the user's options for the table.
#[derive(Clone, Copy)]
pub(super) struct Header<'a> {
    pub(super) fields: &'a [&'a str],
    pub(super) format: &'a TableFormat,
    pub(super) place: Place<'a>,
}

impl Columns {
    /// Finds the quantities of a vocabulary: first the user's choice, then standard headings, then other spellings and
    /// common names.
    ///
    /// If the user chose a quantity other than the time, the search ends there, except [`Beside::Others`].
    ///
    /// # Errors
    /// [`TableError`] for a first row without names unless columns are chosen by number, a choice that fits no column
    /// or several, a unit of another quantity, and two columns of one quantity.
    pub(super) fn find(
        vocabulary: &Vocabulary,
        header: Header,
        beside: Beside,
    ) -> Result<Self, TableError> {
        let (own, is_one_motion) = match beside {
            Beside::Time => (None, true),
            Beside::Column(heading) => (Some(heading), true),
            Beside::Others => (None, false),
        };
        let chosen = header.chosen(vocabulary)?;
        let is_number = |(_, index): &(Quantity, usize)| is_number(header.fields[*index]);
        let first = if !chosen.is_empty() && own.is_none() && chosen.iter().all(is_number) {
            FirstRow::Samples
        } else {
            vocabulary.check_names(header.fields, header.place)?;
            header.check_first_row(&chosen)?;
            FirstRow::Names
        };
        let heading = |&(quantity, index)| header.chosen_heading(quantity, index, first);
        let headings = own.into_iter().map(Ok).chain(chosen.iter().map(heading));
        let headings = headings.collect::<Result<_, _>>()?;
        let (unread, reading) = (Vec::new(), Reading::default());
        let mut columns = Self { headings, first, is_guessed: false, unread, reading };
        if first == FirstRow::Names {
            columns.add_named(vocabulary, header, is_one_motion)?;
        }
        columns.count_times(header)?;
        columns.headings.sort_by_key(|heading| heading.index);
        // The readers of other files choose among their columns first.
        if is_one_motion {
            header.check_measures(&columns.headings)?;
        }
        Ok(columns)
    }

    /// Adds the quantities named in the first row.
    fn add_named(
        &mut self,
        vocabulary: &Vocabulary,
        header: Header,
        is_one_motion: bool,
    ) -> Result<(), TableError> {
        let is_chosen =
            is_one_motion && self.headings.iter().any(|heading| heading.quantity != TIME);
        let free = |(index, field): (usize, &&'_ str)| {
            let is_taken = self.headings.iter().any(|heading| heading.index == index);
            if is_taken { String::new() } else { (*field).to_owned() }
        };
        let free: Vec<String> = header.fields.iter().enumerate().map(free).collect();
        let free: Vec<&str> = free.iter().map(String::as_str).collect();
        let headings = &self.headings;
        let is_sought = |quantity, ways: &[Spelling], found: &[NamedColumn]| {
            // A common name is no second motion besides one with its standard word.
            let is_motion = |(own, _, way): &NamedColumn| *own != TIME && *way != Spelling::Alias;
            let is_second =
                is_one_motion && ways == [Spelling::Alias] && found.iter().any(is_motion);
            (quantity == TIME || !is_chosen && !is_second) && find(headings, quantity).is_none()
        };
        let named = vocabulary.columns((&free, header.place), is_sought)?;
        for (quantity, index, way) in named {
            let field = (index, header.fields[index]);
            self.headings.push(header.heading(quantity, field, way == Spelling::Suffixed)?);
            self.is_guessed |= matches!(way, Spelling::Free | Spelling::Alias);
        }
        let is_read = |index: &usize| self.headings.iter().any(|heading| heading.index == *index);
        let unread = (0..header.fields.len()).filter(|index| !is_chosen && !is_read(index));
        self.unread = unread.collect();
        Ok(())
    }

    /// Adds the times of a rate of samples.
    ///
    /// # Errors
    /// [`TableError`] for a table that has times.
    fn count_times(&mut self, header: Header) -> Result<(), TableError> {
        let Some(rate) = &header.format.sample_rate else { return Ok(()) };
        if let Some(time) = find(&self.headings, TIME) {
            let must = format!("must be left out: {} has the times", time.named());
            let error = header.place.refuse("--sample-rate", rate.to_string(), must);
            return Err(error);
        }
        self.reading.found.push(format!("time from the rate of {rate}"));
        self.headings.push(Heading::counted(header.fields.len()));
        Ok(())
    }

    /// True if the table has a column of this quantity.
    pub(super) fn has(&self, quantity: Quantity) -> bool {
        find(&self.headings, quantity).is_some()
    }

    /// Refuses a table without a column of this quantity.
    pub(super) fn require(&self, quantity: Quantity, header: Header) -> Result<(), TableError> {
        if self.has(quantity) {
            return Ok(());
        }
        Err(refuse_missing(&names(header.fields), quantity.word, header.place))
    }

    /// Refuses two columns that name one thing; `hint` is the remedy.
    pub(super) fn refuse_both(
        &self,
        quantities: [Quantity; 2],
        header: Header,
        hint: &str,
    ) -> Result<(), TableError> {
        let is_one = |heading: &&Heading| quantities.contains(&heading.quantity);
        // Headings stand in the order of their columns.
        let mut both = self.headings.iter().filter(is_one);
        let (Some(first), Some(second)) = (both.next(), both.next()) else { return Ok(()) };
        let first = first.named();
        let must = format!("must not stand beside {first}: both hold one quantity");
        let error = header.place.refuse_column(second.index, &second.name, must);
        Err(error.with_hint(hint.to_owned()))
    }

    /// Descriptions of the used columns for the user.
    pub(super) fn told(&self) -> impl Iterator<Item = String> {
        let columns = self.headings.iter().filter(|heading| !heading.is_counted);
        columns.map(|heading| {
            let Heading { index, quantity, name, unit_text, .. } = heading;
            let from = format!("{} from column {}", quantity.word, index + 1);
            let name = if name.is_empty() || name.eq_ignore_ascii_case(quantity.word) {
                String::new()
            } else {
                format!(" {}", quoted(name))
            };
            let unit = if *quantity == TIME && unit_text == "s" {
                String::new()
            } else {
                format!(" in {unit_text}")
            };
            from + &name + &unit
        })
    }
}

/// Adds the options for the unit of a column to an error.
fn with_options(error: TableError, quantity: Quantity) -> TableError {
    let unit = match quantity {
        TIME => "--time-unit",
        HUB_ANGLE | HUB_RATE => return error,
        _ => "--unit",
    };
    let word = quantity.word;
    error.or_hint(format!("{unit} UNIT or --scale {word}=FACTOR states what its numbers are"))
}

/// True for a field that is a number.
fn is_number(field: &str) -> bool {
    field.parse::<f64>().is_ok()
}

impl Header<'_> {
    /// Quantities that the user chose, each with the index of its column.
    fn chosen(&self, vocabulary: &Vocabulary) -> Result<Vec<(Quantity, usize)>, TableError> {
        let mut chosen: Vec<(Quantity, usize)> = Vec::new();
        for choice in &self.format.columns {
            let quantity = choice.quantity;
            self.check_quantity(vocabulary, quantity, "--columns")?;
            let index = self.index_of(quantity, &choice.column)?;
            if let Some((other, _)) = chosen.iter().find(|(q, i)| *q == quantity || *i == index) {
                let must = format!("must not be the column of {}, too", other.word);
                return Err(self.place.refuse("--columns", quoted(&choice.to_string()), must));
            }
            chosen.push((quantity, index));
        }
        Ok(chosen)
    }

    pub(super) fn check_quantity(
        &self,
        vocabulary: &Vocabulary,
        quantity: Quantity,
        option: &str,
    ) -> Result<(), TableError> {
        if vocabulary.quantities.contains(&quantity) {
            return Ok(());
        }
        let words: Vec<&str> = vocabulary.quantities.iter().map(|known| known.word).collect();
        let must = format!("must be one of {}", words.join(", "));
        Err(self.place.refuse(option, quantity.word, must))
    }

    /// Index of the column with this number or heading.
    pub(super) fn index_of(
        &self,
        quantity: Quantity,
        column: &ColumnName,
    ) -> Result<usize, TableError> {
        let fields = self.fields;
        let heading = match column {
            ColumnName::Number(number) if *number <= fields.len() => return Ok(number - 1),
            ColumnName::Number(number) => {
                let must = format!("must be at most {}, the number of columns", fields.len());
                let found = format!("{}={number}", quantity.word);
                return Err(self.place.refuse("--columns", found, must));
            }
            ColumnName::Heading(heading) => heading,
        };
        let lower = heading.to_lowercase();
        let ways: [&dyn Fn(&str) -> bool; 4] = [
            &|field| field == heading,
            &|field| split_any_unit(field).0 == heading,
            &|field| field.to_lowercase() == lower,
            &|field| split_any_unit(field).0.to_lowercase() == lower,
        ];
        for is_meant in ways {
            let found: Vec<usize> = (0..fields.len()).filter(|i| is_meant(fields[*i])).collect();
            match found[..] {
                [] => {}
                [index] => return Ok(index),
                [first, second, ..] => {
                    let must = format!("must not repeat column {}", first + 1);
                    let error = self.place.refuse_column(second, fields[second], must);
                    let (word, number) = (quantity.word, first + 1);
                    let hint = format!("choose one by its number: --columns {word}={number}");
                    return Err(error.with_hint(hint));
                }
            }
        }
        let names = names(fields);
        let must = format!("must be one of the columns {}", quoted(&names.join(",")));
        let hint = if fields.iter().all(|field| is_number(field)) {
            let by_number = "the first row holds only numbers; a line that begins with # is a comment: choose \
                             columns by number";
            Some(format!("{by_number}, as in {}=2", quantity.word))
        } else {
            nearest(heading, names).map(|near| format!("did you mean {}?", quoted(near)))
        };
        let found = format!("{}={}", quantity.word, quoted(heading));
        Err(self.place.refuse("--columns", found, must).with_hint(hint))
    }

    /// Heading of a column that the user chose.
    fn chosen_heading(
        &self,
        quantity: Quantity,
        index: usize,
        first: FirstRow,
    ) -> Result<Heading, TableError> {
        let measure = self.format.measure(quantity);
        let field = match first {
            FirstRow::Names => self.fields[index],
            FirstRow::Samples => quantity.word,
        };
        if measure.unit.is_none()
            && measure.factor.is_none()
            && split_any_unit(field).1.is_none()
            && let Some(word) = unread_unit(field, quantity)
        {
            let must = format!("must have its unit in brackets: {} reads like one", quoted(word));
            let option = if quantity == TIME { "--time-unit" } else { "--unit" };
            let error = self.place.refuse_column(index, field, must);
            // WinCC writes days since 1899, times 1e6, below Time_ms.
            let is_wincc = quantity == TIME && self.fields.contains(&"VarValue");
            let hint = if is_wincc {
                "--scale time=0.0864 reads WinCC's millionths of days".to_owned()
            } else {
                format!("{option} UNIT names it")
            };
            return Err(error.with_hint(hint));
        }
        self.heading(quantity, (index, field), quantity.is_suffixed(split_unit(field).0))
    }

    /// Refuses names in some of the chosen columns and numbers in others: otherwise a first sample with a gap would
    /// count as names.
    fn check_first_row(&self, chosen: &[(Quantity, usize)]) -> Result<(), TableError> {
        let is_number = |(_, index): &&(Quantity, usize)| is_number(self.fields[*index]);
        if !chosen.iter().any(|pair| is_number(&pair)) {
            return Ok(());
        }
        let must = "must have a name in every column of --columns, or a number in every one";
        let error = self.place.refuse("first row", quoted(&self.fields.join(",")), must);
        Err(error.with_hint("--skip N leaves out lines at the beginning".to_owned()))
    }

    /// Heading of a column with this name; a `suffixed` name contains the SI unit.
    fn heading(
        &self,
        quantity: Quantity,
        (index, field): (usize, &str),
        suffixed: bool,
    ) -> Result<Heading, TableError> {
        let measure = self.format.measure(quantity);
        let heading = Heading::of(index, field, quantity, suffixed, measure, self.place);
        heading.map_err(|error| if suffixed { error } else { with_options(error, quantity) })
    }

    /// Refuses a unit or a factor for an unused column.
    pub(super) fn check_measures(&self, headings: &[Heading]) -> Result<(), TableError> {
        let words = || headings.iter().map(|heading| heading.quantity.word).collect::<Vec<_>>();
        for scale in &self.format.scales {
            if find(headings, scale.quantity).is_none() {
                let must = format!("must be one of the columns read: {}", words().join(", "));
                return Err(self.place.refuse("--scale", scale.quantity.word, must));
            }
        }
        let Some(unit) = &self.format.unit else { return Ok(()) };
        let fits = |heading: &Heading| heading.quantity != TIME && heading.quantity.takes(unit);
        if headings.iter().any(fits) {
            return Ok(());
        }
        let mut words = words();
        words.retain(|word| *word != TIME.word);
        let must = format!("must be a unit of a column read: {}", words.join(", "));
        Err(self.place.refuse("--unit", quoted(&unit.to_string()), must))
    }
}
