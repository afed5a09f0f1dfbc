//! What libraries of other projects say of our documents and modules.
//!
//! Without the feature `peers`, as in plain `cargo test`, nobody is asked. A complete test run must have it.

use std::string::String;
#[cfg(feature = "peers")]
use std::{format, string::ToString};

/// A JSON Schema, read by a validator.
pub struct Schema {
    #[cfg(feature = "peers")]
    schemas: boon::Schemas,
    #[cfg(feature = "peers")]
    index: boon::SchemaIndex,
}

impl Schema {
    /// Reads a schema; `None` if nobody is asked.
    ///
    /// # Panics
    /// If the text is no schema, and in a complete test run in which nobody is asked.
    #[must_use]
    pub fn new(text: &str) -> Option<Self> {
        #[cfg(feature = "peers")]
        {
            let mut schemas = boon::Schemas::new();
            let mut compiler = boon::Compiler::new();
            let document = serde_json::from_str(text).expect("JSON");
            compiler
                .add_resource("it.schema.json", document)
                .expect("a schema");
            let index = compiler
                .compile("it.schema.json", &mut schemas)
                .expect("a schema");
            Some(Self { schemas, index })
        }
        #[cfg(not(feature = "peers"))]
        {
            let _ = text;
            nobody_is_asked();
            None
        }
    }

    /// Whether a document fulfils the schema.
    ///
    /// # Errors
    /// Why it does not, or why it is no JSON.
    pub fn check(&self, document: &str) -> Result<(), String> {
        #[cfg(feature = "peers")]
        {
            let value = serde_json::from_str(document).map_err(|error| error.to_string())?;
            let found = self.schemas.validate(&value, self.index);
            found.map_err(|error| format!("{error:#}"))
        }
        #[cfg(not(feature = "peers"))]
        unreachable!("nobody read a schema for {document}")
    }
}

/// Whether a module of WebAssembly is valid; `Ok` if nobody is asked.
///
/// # Errors
/// Why it is not.
///
/// # Panics
/// In a complete test run in which nobody is asked.
pub fn module(bytes: &[u8]) -> Result<(), String> {
    #[cfg(feature = "peers")]
    {
        let found = wasmparser::validate(bytes);
        found.map(|_| ()).map_err(|error| error.to_string())
    }
    #[cfg(not(feature = "peers"))]
    {
        let _ = bytes;
        nobody_is_asked();
        Ok(())
    }
}

#[cfg(not(feature = "peers"))]
fn nobody_is_asked() {
    assert!(!crate::searches(), "add `--features standstill-testkit/peers`");
}
