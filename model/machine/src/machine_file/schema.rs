//! The machine file's keys as JSON Schema (draft 07), for editors that complete and check TOML, such as those that use Taplo.
//!
//! A schema limits the values of each key by itself. Only [`super::parse`] checks conditions on several keys (a PWM
//! period of whole clocks, a travel that the word holds), so it may refuse a file that the schema accepts.

use serde_json::{Map, Value, json};

use super::axis::{NEEDS, Need, REPLACED_BY_STEPS};
use super::key::{Default, Key, Values};
use super::machine::KEYS;
use super::names::{MAX_NAME_LENGTH, NAME_RULE};
use super::range::NumberRange;

/// Returns the schema of the whole file.
///
/// ```
/// let schema = posicast_machine::machine_file::schema();
/// let damping = &schema["properties"]["axis"]["items"]["properties"]["mode"]["items"]["properties"]["damping"];
/// assert_eq!(damping["minimum"], 0.0);
/// assert_eq!(damping["exclusiveMaximum"], 1.0);
/// ```
pub fn schema() -> Value {
    let mut schema = Map::new();
    schema.insert("$schema".to_owned(), json!("http://json-schema.org/draft-07/schema#"));
    schema.insert("title".to_owned(), json!("Machine file of posicast"));
    schema.extend(table(KEYS));
    Value::Object(schema)
}

/// A table with these keys and no other.
fn table(keys: &[Key]) -> Map<String, Value> {
    let properties: Map<String, Value> = keys.iter().map(|key| (key.name.to_owned(), property(key))).collect();
    let required: Vec<&str> = keys.iter().filter(|key| key.required).map(|key| key.name).collect();
    let mut schema = Map::new();
    schema.insert("type".to_owned(), json!("object"));
    if !required.is_empty() {
        schema.insert("required".to_owned(), json!(required));
    }
    let needs = NEEDS.iter().filter(|need| properties.contains_key(need.block));
    let needs: Map<String, Value> = needs.map(|need| (need.block.to_owned(), of_need(need))).collect();
    let needed = keys
        .iter()
        .filter_map(|key| Some((key.needed_by?.to_owned(), json!([key.name]))));
    let needs: Map<String, Value> = needs.into_iter().chain(needed).collect();
    if !needs.is_empty() {
        schema.insert("dependencies".to_owned(), Value::Object(needs));
    }
    if let Some(other) = keys.iter().find_map(|key| key.instead_of) {
        let others = keys.iter().filter(|key| key.instead_of == Some(other));
        let one: Vec<&str> = std::iter::once(other).chain(others.map(|key| key.name)).collect();
        let one: Vec<Value> = one.iter().map(|key| alternative(keys, key, &one)).collect();
        schema.insert("oneOf".to_owned(), json!(one));
    }
    schema.insert("additionalProperties".to_owned(), json!(false));
    schema.insert("properties".to_owned(), Value::Object(properties));
    schema
}

/// Returns what a block requires of the other tables of its axis.
fn of_need(need: &Need) -> Value {
    if need.block == "steps" {
        let replaced = REPLACED_BY_STEPS.map(|block| json!({ "required": [block] }));
        return json!({ "required": need.others, "not": { "anyOf": replaced } });
    }
    match need.or {
        None => json!(need.others),
        Some(or) => json!({ "anyOf": [{ "required": need.others }, { "required": [or] }] }),
    }
}

/// Returns the schema of a table with this key and without the other ones in `all`. If no word of another key selects this one, `oneOf`
/// already excludes them.
fn alternative(keys: &[Key], name: &str, all: &[&str]) -> Value {
    let key = keys.iter().find(|key| key.name == name);
    let Some((by, word)) = key.and_then(|key| key.chosen_by) else {
        return json!({ "required": [name] });
    };
    let default = keys.iter().find(|key| key.name == by).and_then(|key| key.default);
    let required = match default {
        Some(Default::Word(usual)) if usual == word => vec![name],
        _ => vec![name, by],
    };
    let others = all.iter().filter(|other| **other != name);
    let mut properties: Map<String, Value> = others.map(|other| ((*other).to_owned(), json!(false))).collect();
    properties.insert(by.to_owned(), json!({ "const": word }));
    json!({ "required": required, "properties": properties })
}

fn property(key: &Key) -> Value {
    let mut schema = Map::new();
    schema.insert("description".to_owned(), json!(key.about));
    schema.extend(values(key.values));
    if let Some(default) = key.default {
        let value = match default {
            Default::Number(number) => json!(number),
            Default::Integer(number) => json!(number),
            Default::Boolean(flag) => json!(flag),
            Default::Word(word) => json!(word),
        };
        schema.insert("default".to_owned(), value);
    }
    Value::Object(schema)
}

fn values(values: Values) -> Map<String, Value> {
    let schema = match values {
        Values::Number(range) => return number(range),
        Values::Quantity(range) | Values::Counts(range) => return number(range.in_any_unit()),
        Values::Table(keys) => return table(keys),
        Values::Integer(low, high) => json!({ "type": "integer", "minimum": low, "maximum": high }),
        Values::OneOf(list) => json!({ "type": "integer", "enum": list }),
        Values::Boolean => json!({ "type": "boolean" }),
        Values::Name => json!({
            "type": "string", "pattern": "^[a-z][a-z0-9_]*$", "maxLength": MAX_NAME_LENGTH, "$comment": NAME_RULE,
        }),
        Values::CsvName => json!({ "type": "string", "pattern": "^[A-Za-z0-9_-][A-Za-z0-9._ -]*\\.csv$" }),
        Values::Word(words) => json!({ "type": "string", "enum": words() }),
        Values::Words(words) => json!({ "type": "array", "items": { "type": "string", "enum": words() } }),
        Values::WordOrPair(words, range) => json!({ "anyOf": [{ "type": "string", "enum": words() }, pair(range)] }),
        Values::PlainPair(range) => pair(range),
        Values::Pair(range) => pair(range.in_any_unit()),
        Values::Pairs(range, most) => json!({ "type": "array", "minItems": 1, "maxItems": most, "items": pair(range) }),
        Values::Rows(ranges, most) => {
            let numbers: Vec<Map<String, Value>> = ranges.iter().map(|range| number(*range)).collect();
            let row = json!({ "type": "array", "minItems": ranges.len(), "maxItems": ranges.len(), "items": numbers });
            json!({ "type": "array", "minItems": 1, "maxItems": most, "items": row })
        }
        Values::Numbers(range, most) => {
            json!({ "type": "array", "minItems": 1, "maxItems": most, "items": number(range) })
        }
        Values::Tables(keys, most) => json!({ "type": "array", "minItems": 1, "maxItems": most, "items": table(keys) }),
    };
    match schema {
        Value::Object(schema) => schema,
        _ => Map::new(),
    }
}

fn pair(range: NumberRange) -> Value {
    json!({ "type": "array", "minItems": 2, "maxItems": 2, "items": number(range) })
}

fn number(range: NumberRange) -> Map<String, Value> {
    let mut schema = Map::new();
    schema.insert("type".to_owned(), json!("number"));
    let ends = [
        ("minimum", "exclusiveMinimum", range.low()),
        ("maximum", "exclusiveMaximum", range.high()),
    ];
    for (closed, open, (end, included)) in ends {
        let name = if included { closed } else { open };
        schema.insert(name.to_owned(), json!(end));
    }
    schema
}
