//! Tufts from a script's tables.

use super::*;

fn table(fields: &[(&str, Value)]) -> Table {
    Table { items: vec![], fields: fields.iter().map(|(k, v)| ((*k).to_owned(), v.clone())).collect() }
}

fn list(items: Vec<Value>) -> Value {
    Value::Table(Table { items, ..Table::default() })
}

#[test]
fn tables_become_tufts() {
    let solid = ball();
    let line = list(vec![Value::Vector(Vec3::Y * 9.0), Value::Vector(Vec3::Y * 15.0)]);
    let read = |more: &[(&str, Value)]| {
        let mut fields = vec![("stroke", line.clone())];
        fields.extend_from_slice(more);
        params::read::<TuftOptions>(&table(&fields))
    };
    let built = read(&[("diameter", Value::Number(25.0)), ("peak", Value::Number(80.0))]).unwrap();
    let t = built.build(&ground(&solid)).unwrap().value;
    assert_eq!(t.section.profile, Profile::Round { diameter: 2.5, peak: 0.8 });
    for (field, bad) in [("diameter", 0.5), ("diameter", 101.0), ("peak", 0.0), ("peak", 100.5)] {
        let problems = read(&[(field, Value::Number(bad))]).unwrap_err();
        assert_eq!(
            (problems[0].path.as_str(), problems[0].message.clone()),
            (field, format!("`{bad}` is out of range"))
        );
    }
    assert!(params::read::<FillOptions>(&table(&[("up", Value::Number(0.0))])).is_err());
    let row = |a: f64, b: f64, c: f64| list([a, b, c].map(Value::Number).to_vec());
    let sizes = list(vec![row(0.0, 1.0, 0.5), row(0.5, 2.0, 1.0), row(1.0, 0.0, 0.0)]);
    let profile = read(&[("profile", sizes.clone()), ("tips", Value::Number(2.0))]).unwrap();
    assert_eq!(profile.section().unwrap().split.map(|s| s.tips), Some(2));
    let radii = [("horizontal", Value::Number(1.0)), ("vertical", Value::Number(0.5))];
    let both = read(&[("profile", sizes), ("ellipse", Value::Table(table(&radii)))]).unwrap();
    assert_eq!(both.section().unwrap_err(), TuftError::Exclusive { first: "ellipse", second: "profile" });
    let rings = read(&[("rings", Value::Number(5.0))]).unwrap();
    assert_eq!(rings.detail().unwrap_err(), TuftError::RingsWithoutSides);
    // Every description can be read back from nothing but its required fields.
    assert!(FillOptions::fields().iter().all(|f| !f.is_required()));
    assert!(RingOptions::fields().iter().filter(|f| f.is_required()).map(|f| f.name).eq(["at"]));
}

#[test]
fn ids_are_unique_and_stable() {
    let t = tuft(Section::round(2.0, 0.3));
    let twice = Tufts::new(vec![t.clone(), t.clone(), t.clone()], "a");
    twice.validate().unwrap();
    assert_eq!(twice.tufts[0].id, t.id);
    let mut all = Tufts::new(vec![t.clone()], "b");
    all.extend(&twice);
    all.validate().unwrap();
    assert_eq!((all.sources.len(), all.tufts[3].source), (2, 1));
    assert_eq!(Tufts::default().mesh().mesh, Mesh::default());
}
