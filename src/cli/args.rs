//! The command line, as `clap` reads it.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, Parser, Subcommand};

use super::proof::{DiffArguments, SheetArguments, TestArguments};
use super::show::Show;
use crate::export::{Format, MotionForm, StrandForm};
use crate::head::load::Unit;
use crate::scene::{Background, View};
use crate::script::{Limits, limits};

/// Hairstyles that are written: runs a Lua script, draws its picture, exports its hair.
#[derive(Debug, Parser)]
#[command(name = "coif", version, about, max_term_width = 100, after_help = EXIT_CODES)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

const EXIT_CODES: &str = "\
Exit status:
  0    done
  1    the script, or a file that it asked for, is at fault
  2    the command line is at fault
  3    a file could not be written
  70   an error in Coif itself
  130  cancelled by Ctrl-C";

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run a script; write its picture and its GLB
    Run(Box<RunArguments>),
    /// Run a script, and again whenever it or a file that it asked for is saved
    Watch(Box<WatchArguments>),
    /// List the parameters of a script
    Params(ParamsArguments),
    /// Make a folder with a new style, a test of it and settings for the editor
    New(NewArguments),
    /// Write the definitions for editors and the reference of all functions
    Api(ApiArguments),
    /// Draw variations of a style on one contact sheet
    Sheet(Box<SheetArguments>),
    /// Run scripted tests of styles, *_test.lua
    Test(TestArguments),
    /// Tell what changed between two styles, or two versions of one
    Diff(Box<DiffArguments>),
}

/// What is common to every command that runs a script.
#[derive(Args, Debug)]
pub struct ScriptArguments {
    /// The hairstyle, a Lua script
    pub script: PathBuf,
    /// Give a parameter of the script another value; may be repeated
    #[arg(long, value_name = "NAME=VALUE", value_parser = assignment)]
    pub set: Vec<(String, String)>,
    /// Seed of all randomness
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// Head to style instead of the one that the script's `coif.head()` gives: OBJ, glTF or GLB
    #[arg(long, value_name = "FILE")]
    pub head: Option<PathBuf>,
    /// What one unit of that head's file is, if not what its format says [mm, cm, dm, m, in, ft]
    #[arg(long, value_name = "UNIT", requires = "head", value_parser = unit)]
    pub head_unit: Option<Unit>,
    /// Let the script read below this folder too, besides its own; may be repeated
    #[arg(long, value_name = "DIR")]
    pub allow: Vec<PathBuf>,
    #[command(flatten)]
    pub limits: LimitArguments,
    /// Threads to use; all of the machine's by default. The result does not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
}

/// How much a script may take, for every command that runs one.
#[derive(Args, Clone, Copy, Debug)]
pub struct LimitArguments {
    /// Stop a script after this time
    #[arg(long, value_name = "SECONDS", default_value = "60", value_parser = seconds)]
    pub time_limit: Duration,
    /// Refuse what needs more memory for its geometry
    #[arg(long, value_name = "SIZE", default_value = "4GB", value_parser = amount)]
    pub memory_limit: u64,
    /// Refuse strands with more points than this, all together
    #[arg(long, value_name = "N", default_value = "200M", value_parser = amount)]
    pub points_limit: u64,
    /// Refuse heads and tufts with more triangles than this, all together
    #[arg(long, value_name = "N", default_value = "20M", value_parser = amount)]
    pub triangles_limit: u64,
}

impl LimitArguments {
    /// The limits other than time.
    pub fn limits(&self) -> Limits {
        Limits { memory: self.memory_limit, points: self.points_limit, triangles: self.triangles_limit }
    }
}

/// `coif run`.
#[derive(Args, Debug)]
pub struct RunArguments {
    #[command(flatten)]
    pub script: ScriptArguments,
    /// Folder for the outputs, NAME.png and NAME.glb
    #[arg(short, long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    /// Write NAME.debug.png too: domains, guides by stage, partings, roots
    #[arg(long)]
    pub debug: bool,
    /// Write NAME.guides.glb too: the guides as lines
    #[arg(long)]
    pub guides: bool,
    /// Background of the picture, instead of the script's [white, dark]
    #[arg(long, value_name = "COLOUR", value_parser = background)]
    pub background: Option<Background>,
    /// Views of the picture, instead of the script's [front, back, left, right, top, three-quarter, ...]
    #[arg(long, value_name = "VIEW,...", value_delimiter = ',', value_parser = view)]
    pub views: Option<Vec<View>>,
    /// Width of one view in pixels
    #[arg(long, value_name = "PX", default_value_t = 640, value_parser = clap::value_parser!(u32).range(16..=8192))]
    pub size: u32,
    /// Samples per pixel along each side: more is finer and slower; 2, in `watch` 1, when left out
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4))]
    pub samples: Option<u32>,
    /// Files for other programs [glb, usda, hair]; NAME.glb alone when left out
    #[arg(long, value_name = "FORMAT,...", value_delimiter = ',', default_value = "glb", value_parser = format)]
    pub format: Vec<Format>,
    /// Write NAME.turntable.png too: an animated picture that goes once around the head
    #[arg(long)]
    pub turntable: bool,
    /// Of a scene that moves, write neither NAME.strip.png nor NAME.anim.png
    #[arg(long)]
    pub still: bool,
    /// What strands become in the GLB [ribbons, lines, none]
    #[arg(long, value_name = "FORM", default_value = "ribbons", value_parser = form)]
    pub strands: StrandForm,
    /// Farthest that a strand in the GLB may lie from its true course, and what moves from its place at any frame; 0.1 when
    /// left out, in motion a fiftieth of their way for strands that move farther than 5 cm
    #[arg(long, value_name = "CM", value_parser = tolerance)]
    pub tolerance: Option<f32>,
    /// How strands that move are written in the GLB [auto, shapes, joints]
    #[arg(long, value_name = "FORM", default_value = "auto", value_parser = motion)]
    pub motion: MotionForm,
    /// Bring all stylised hair (tufts, caps, buns, rings) within this many triangles, less first where it shows least
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub triangles: Option<u32>,
    /// Print one JSON object on standard output: counts per part, times per stage, files
    #[arg(long)]
    pub stats: bool,
    /// Tell the time of every call of the script
    #[arg(long)]
    pub timings: bool,
    /// Draw the picture in the terminal [auto, kitty, iterm, sixel, half]
    #[arg(long, value_name = "HOW", num_args = 0..=1, require_equals = true, default_missing_value = "auto", value_parser = show)]
    pub show: Option<Show>,
    /// Print errors and warnings only
    #[arg(short, long)]
    pub quiet: bool,
}

/// `coif watch`.
#[derive(Args, Debug)]
pub struct WatchArguments {
    #[command(flatten)]
    pub run: RunArguments,
    /// Look at the files regularly, for file systems that tell nothing (network, containers)
    #[arg(long)]
    pub poll: bool,
    /// Wait for the whole picture, without a draft before it
    #[arg(long)]
    pub no_draft: bool,
    /// Print one JSON object per event on standard output, and nothing else
    #[arg(long, conflicts_with = "show")]
    pub json: bool,
}

/// `coif params`.
#[derive(Args, Debug)]
pub struct ParamsArguments {
    #[command(flatten)]
    pub script: ScriptArguments,
    /// Print JSON instead of a table
    #[arg(long)]
    pub json: bool,
}

/// `coif new`.
#[derive(Args, Debug)]
pub struct NewArguments {
    /// Folder to make; its last part is the style's name
    #[arg(value_name = "NAME")]
    pub folder: PathBuf,
}

/// `coif api`.
#[derive(Args, Debug)]
pub struct ApiArguments {
    /// Folder for `coif.lua`, the library and the pages
    #[arg(short, long, value_name = "DIR", default_value = crate::workbench::DEFINITIONS)]
    pub out: PathBuf,
}

fn assignment(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() => Ok((name.trim().to_owned(), value.to_owned())),
        _ => Err("write NAME=VALUE, as in length=60".to_owned()),
    }
}

pub(super) fn seconds(text: &str) -> Result<Duration, String> {
    let seconds: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if seconds > 0.0 && seconds <= 1e6 {
        Ok(Duration::from_secs_f64(seconds))
    } else {
        Err("it takes more than 0 seconds".to_owned())
    }
}

fn amount(text: &str) -> Result<u64, String> {
    limits::count(text).ok_or_else(|| "write a number, as in 500k, 40M or 1.5G".to_owned())
}

fn tolerance(text: &str) -> Result<f32, String> {
    let value: f32 = text.parse().map_err(|_| "not a number".to_owned())?;
    if (0.0..=10.0).contains(&value) { Ok(value) } else { Err("it takes 0 to 10 cm".to_owned()) }
}

fn choice<T>(text: &str, texts: &[&str], parse: fn(&str) -> Option<T>) -> Result<T, String> {
    parse(text).ok_or_else(|| match crate::params::nearest(text, texts.iter().copied()) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("it takes {}", texts.join(", ")),
    })
}

pub(super) fn background(text: &str) -> Result<Background, String> {
    choice(text, Background::TEXTS, Background::parse)
}

pub(super) fn view(text: &str) -> Result<View, String> {
    choice(text, View::TEXTS, View::parse)
}

fn unit(text: &str) -> Result<Unit, String> {
    choice(text, Unit::TEXTS, Unit::parse)
}

fn form(text: &str) -> Result<StrandForm, String> {
    choice(text, StrandForm::TEXTS, StrandForm::parse)
}

fn motion(text: &str) -> Result<MotionForm, String> {
    choice(text, MotionForm::TEXTS, MotionForm::parse)
}

fn format(text: &str) -> Result<Format, String> {
    choice(text, Format::TEXTS, Format::parse)
}

fn show(text: &str) -> Result<Show, String> {
    choice(text, Show::TEXTS, Show::parse)
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    #[test]
    fn the_arguments_fit_together() {
        super::Arguments::command().debug_assert();
    }
}
