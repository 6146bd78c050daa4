//! Parameters, described once.
//!
//! A method's options are a plain Rust struct made by [`params!`](crate::params!): every field has a type, a unit, a
//! range, a default and a line of doc. From that one description come the strict reading of a script's table (this
//! module), the reference pages and the editor definitions (the script floor). This module knows no Lua: a script's
//! table arrives as a [`Value`], plain data.
//!
//! ```
//! use coif::params::{self, Params, Value, Table};
//!
//! coif::params! {
//!     /// A wave along a strand.
//!     pub struct Wave("coif.wave") {
//!         /// Length of one wave.
//!         period: f32, unit("cm"), range(0.1, 1000.0);
//!         /// Greatest distance from the axis.
//!         radius: f32 = 0.5, unit("cm"), range(0.0, 100.0);
//!     }
//! }
//!
//! let mut table = Table::default();
//! table.fields.insert("perod".into(), Value::Number(3.0));
//! let problems = params::read::<Wave>(&table).unwrap_err();
//! assert_eq!(problems[0].message, "unknown field `perod`");
//! assert_eq!(problems[0].hint.as_deref(), Some("did you mean `period`?"));
//! ```

mod describe;
mod read;
mod types;
mod value;

pub use describe::{Field, Kind, Params};
pub use read::{FieldType, Problem, Reader, nearest, read};
pub use types::{Angle, Direction, Function};
pub use value::{Handle, Object, Table, Value};

/// Declares a parameter struct and everything derived from it; see the [module](mod@crate::params) for an example.
///
/// `field: Type;` is required, `field: Type = default;` has a default, `field: Option<Type>;` may be left out. After
/// that, in any order: `unit("cm")`, `range(lo, hi)` (both included), `positional()` (the list part of the table), and for
/// the editor `takes("(root: vector): boolean")` and `choices(&["a", "b"])` where the type alone says too little.
#[macro_export]
macro_rules! params {
    (
        $(#[doc = $doc:literal])*
        $(#[derive($($derive:ident),*)])?
        $vis:vis struct $name:ident($lua:literal) {
            $(
                $(#[doc = $fdoc:literal])*
                $field:ident : $ty:ty $(= $default:expr)? $(, $key:ident ( $($arg:expr),* ))* ;
            )*
        }
    ) => {
        $(#[doc = $doc])*
        #[derive(Clone, Debug $($(, $derive)*)?)]
        $vis struct $name {
            $( $(#[doc = $fdoc])* pub $field: $ty, )*
        }

        impl $crate::params::Params for $name {
            const NAME: &'static str = $lua;
            const DOC: &'static str = concat!($($doc, "\n"),*);

            fn fields() -> Vec<$crate::params::Field> {
                vec![$(
                    $crate::params::Field::new::<$ty>(stringify!($field), concat!($($fdoc, "\n"),*))
                        $(.default(&{ let v: $ty = $default; v }))?
                        $(.$key($($arg),*))*
                ),*]
            }

            fn read(table: &$crate::params::Table, reader: &mut $crate::params::Reader) -> Option<Self> {
                let fields = <Self as $crate::params::Params>::fields();
                reader.reject_unknown(table, &fields, Self::NAME);
                let mut at = fields.iter();
                $(
                    #[allow(unused_mut, unused_assignments)]
                    let mut default: Option<$ty> = None;
                    $( default = Some($default); )?
                    let $field: Option<$ty> = reader.field(table, at.next()?, default);
                )*
                Some(Self { $($field: $field?),* })
            }
        }

        impl $crate::params::FieldType for $name {
            fn kind() -> $crate::params::Kind {
                $crate::params::Kind::Struct($lua)
            }
            fn nested() -> Option<fn() -> Vec<$crate::params::Field>> {
                Some(<Self as $crate::params::Params>::fields)
            }
            fn read(value: &$crate::params::Value, reader: &mut $crate::params::Reader) -> Option<Self> {
                match value {
                    $crate::params::Value::Table(table) => <Self as $crate::params::Params>::read(table, reader),
                    other => reader.wrong_type("a table", other),
                }
            }
        }
    };
}

/// Declares an enum whose variants a script names by text, for use as a field of [`params!`](crate::params!).
#[macro_export]
macro_rules! choices {
    (
        $(#[doc = $doc:literal])*
        $vis:vis enum $name:ident { $( $(#[doc = $vdoc:literal])* $variant:ident = $text:literal ),* $(,)? }
    ) => {
        $(#[doc = $doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        $vis enum $name { $( $(#[doc = $vdoc])* $variant ),* }

        impl $name {
            /// Every choice, as a script writes it.
            pub const TEXTS: &'static [&'static str] = &[$($text),*];

            /// The choice of that text.
            pub fn parse(text: &str) -> Option<Self> {
                match text { $($text => Some(Self::$variant),)* _ => None }
            }

            /// The text of this choice.
            pub const fn text(self) -> &'static str {
                match self { $(Self::$variant => $text),* }
            }
        }

        impl $crate::params::FieldType for $name {
            fn kind() -> $crate::params::Kind {
                $crate::params::Kind::Choice(Self::TEXTS)
            }
            fn read(value: &$crate::params::Value, reader: &mut $crate::params::Reader) -> Option<Self> {
                reader.choice(value, Self::TEXTS).and_then(Self::parse)
            }
            fn show(&self) -> String {
                format!("\"{}\"", self.text())
            }
        }
    };
}
