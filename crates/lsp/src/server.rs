//! The loop: messages in, answers and diagnostics out.

use crate::documents::{Documents, Kind, key, kind};
use crate::script::{self, Asked};
use crate::text::Project;
use lsp_server::{Connection, ErrorCode, Message, Notification, Request, Response};
use lsp_types::{
    CompletionOptions, Diagnostic, DidChangeTextDocumentParams, DidCloseTextDocumentParams,
    DidOpenTextDocumentParams, HoverProviderCapability, OneOf, PublishDiagnosticsParams, ServerCapabilities,
    TextDocumentIdentifier, TextDocumentPositionParams, TextDocumentSyncCapability, TextDocumentSyncKind,
    TextEdit, Uri,
};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use standstill_st::{Dialect, SOURCES_MOST};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The end of a session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// By `shutdown` and `exit`.
    Exit,
    /// By `exit` alone, which the protocol calls an error.
    ExitAtOnce,
    /// The editor closed its end.
    Closed,
}

/// Runs the language server over a connection until the session ends.
pub fn serve(connection: &Connection, dialect: &Dialect) -> Ended {
    let mut server = Server {
        connection,
        dialect,
        documents: Documents::default(),
        told: BTreeMap::new(),
        changed: false,
        shut: false,
        ready: false,
    };
    server.serve()
}

struct Server<'c> {
    connection: &'c Connection,
    dialect: &'c Dialect,
    documents: Documents,
    /// The last published diagnostics, by document.
    told: BTreeMap<PathBuf, (Uri, Vec<Diagnostic>)>,
    /// Whether a document changed since diagnostics were published.
    changed: bool,
    /// Whether `shutdown` was received.
    shut: bool,
    /// Whether `initialize` was answered.
    ready: bool,
}

/// The reason why a request has no result.
type Refusal = (ErrorCode, String);

impl Server<'_> {
    fn serve(&mut self) -> Ended {
        loop {
            // Nothing is checked while changes wait to be read, because the result would be out of date.
            let message = match self.connection.receiver.try_recv() {
                Ok(message) => message,
                Err(_) => {
                    self.publish();
                    match self.connection.receiver.recv() {
                        Ok(message) => message,
                        Err(_) => return Ended::Closed,
                    }
                }
            };
            match message {
                Message::Request(request) => self.request(request),
                Message::Notification(it) if it.method == "exit" => {
                    return if self.shut { Ended::Exit } else { Ended::ExitAtOnce };
                }
                Message::Notification(it) => self.notification(it),
                // This server sends no requests.
                Message::Response(_) => {}
            }
        }
    }

    fn send(&self, message: Message) {
        // An editor that is gone receives nothing; the next read reports it.
        let _gone = self.connection.sender.send(message);
    }

    fn notify(&self, method: &str, params: impl Serialize) {
        self.send(Message::Notification(Notification::new(
            method.to_owned(),
            params,
        )));
    }

    fn request(&mut self, request: Request) {
        let id = request.id.clone();
        let answer = match self.answer(request) {
            Ok(result) => Response::new_ok(id, result),
            Err((code, message)) => Response::new_err(id, code as i32, message),
        };
        self.send(Message::Response(answer));
    }

    fn answer(&mut self, request: Request) -> Result<Value, Refusal> {
        let method = request.method.as_str();
        match method {
            "initialize" if self.ready => Err((
                ErrorCode::InvalidRequest,
                "the session has begun already".to_owned(),
            )),
            "initialize" => {
                self.ready = true;
                Ok(json!({
                    "capabilities": capabilities(),
                    "serverInfo": {"name": "standstill", "version": env!("CARGO_PKG_VERSION")},
                }))
            }
            _ if !self.ready => Err((
                ErrorCode::ServerNotInitialized,
                "`initialize` comes first".to_owned(),
            )),
            _ if self.shut => Err((
                ErrorCode::InvalidRequest,
                "after `shutdown` only `exit` follows".to_owned(),
            )),
            "shutdown" => {
                self.shut = true;
                Ok(Value::Null)
            }
            "textDocument/hover" => self.asked(request.params, Self::hover),
            "textDocument/definition" => self.asked(request.params, Self::definition),
            "textDocument/completion" => self.asked(request.params, Self::completion),
            "textDocument/formatting" => self.formatting(request.params),
            _ => Err((
                ErrorCode::MethodNotFound,
                format!("`{method}` is nothing that this server does"),
            )),
        }
    }

    /// Answers a question about a place in a document; the answer is empty if the document is not ours.
    fn asked(
        &self,
        params: Value,
        answer: impl FnOnce(&Self, &Path, Kind, &TextDocumentPositionParams) -> Value,
    ) -> Result<Value, Refusal> {
        let params: TextDocumentPositionParams = parameters(params)?;
        let path = key(&params.text_document.uri);
        Ok(match kind(&path) {
            Some(kind) => answer(self, &path, kind, &params),
            None => Value::Null,
        })
    }

    fn project(&self, path: &Path) -> Project {
        Project::new(&self.documents, &self.documents.project(path), self.dialect)
    }

    fn script(&self, path: &Path, at: &TextDocumentPositionParams) -> Option<Asked<'_>> {
        Asked::new(&self.documents, path, at.position, self.dialect)
    }

    fn hover(&self, path: &Path, kind: Kind, at: &TextDocumentPositionParams) -> Value {
        let found = match kind {
            Kind::StructuredText => self.project(path).hover(path, at.position),
            Kind::Script => self.script(path, at).and_then(|it| it.hover()),
        };
        json!(found)
    }

    fn definition(&self, path: &Path, kind: Kind, at: &TextDocumentPositionParams) -> Value {
        let found = match kind {
            Kind::StructuredText => self.project(path).definition(path, at.position),
            Kind::Script => self.script(path, at).and_then(|it| it.definition()),
        };
        json!(found)
    }

    fn completion(&self, path: &Path, kind: Kind, at: &TextDocumentPositionParams) -> Value {
        let found = match kind {
            Kind::StructuredText => self.project(path).completions(path, at.position),
            Kind::Script => {
                let asked = self.script(path, at);
                asked.map(|it| it.completions()).unwrap_or_default()
            }
        };
        json!(found)
    }

    /// The whole document laid out; empty if it cannot be read, because its mistakes are already
    /// published.
    fn formatting(&self, params: Value) -> Result<Value, Refusal> {
        #[derive(Deserialize)]
        #[serde(rename_all = "camelCase")]
        struct Wanted {
            text_document: TextDocumentIdentifier,
        }
        let wanted: Wanted = parameters(params)?;
        let path = key(&wanted.text_document.uri);
        let (Some(kind), Ok(text)) = (kind(&path), self.documents.text(&path)) else {
            return Ok(Value::Null);
        };
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let laid_out = match kind {
            Kind::StructuredText => standstill_st::format(&name, text.as_str().as_bytes()).ok(),
            Kind::Script => standstill_script::format(text.as_str(), &name).ok(),
        };
        Ok(match laid_out {
            None => Value::Null,
            Some(new) if new == text.as_str() => json!([]),
            Some(new_text) => json!([TextEdit {
                range: text.whole(),
                new_text,
            }]),
        })
    }

    /// Takes a change. A notification that is invalid or not ours changes nothing.
    fn notification(&mut self, it: Notification) {
        if !self.ready || self.shut {
            return;
        }
        match it.method.as_str() {
            "textDocument/didOpen" => {
                if let Ok(params) = parameters::<DidOpenTextDocumentParams>(it.params) {
                    let document = params.text_document;
                    self.put(document.uri, document.version, document.text);
                }
            }
            "textDocument/didChange" => {
                if let Ok(mut params) = parameters::<DidChangeTextDocumentParams>(it.params)
                    && let Some(change) = params.content_changes.pop()
                {
                    let document = params.text_document;
                    self.put(document.uri, document.version, change.text);
                }
            }
            "textDocument/didClose" => {
                if let Ok(params) = parameters::<DidCloseTextDocumentParams>(it.params) {
                    self.documents.remove(&params.text_document.uri);
                    self.changed = true;
                }
            }
            // Files beside the documents may have changed.
            "textDocument/didSave" | "workspace/didChangeWatchedFiles" => self.changed = true,
            _ => {}
        }
    }

    fn put(&mut self, uri: Uri, version: i32, text: String) {
        // A text above the compiler's limit is reported and not kept.
        let text = if text.len() > SOURCES_MOST {
            self.too_large(&uri, text.len());
            String::new()
        } else {
            text
        };
        self.documents.put(uri, version, text);
        self.changed = true;
    }

    fn too_large(&self, uri: &Uri, bytes: usize) {
        let message = format!(
            "{} has {bytes} bytes, more than the {SOURCES_MOST} that are read",
            uri.as_str()
        );
        self.notify("window/showMessage", json!({"type": 2, "message": message}));
    }

    /// Publishes the mistakes of every document, if they have changed.
    fn publish(&mut self) {
        if !std::mem::take(&mut self.changed) {
            return;
        }
        let mut found = self.diagnostics();
        let gone = self.told.keys().filter(|path| !found.contains_key(*path));
        let gone: Vec<_> = gone.cloned().collect();
        for path in gone {
            if let Some((uri, diagnostics)) = self.told.remove(&path)
                && !diagnostics.is_empty()
            {
                self.tell(uri, None, Vec::new());
            }
        }
        let documents: Vec<_> = self
            .documents
            .iter()
            .map(|(path, document)| (path.clone(), document.uri.clone(), document.version))
            .collect();
        for (path, uri, version) in documents {
            let Some(diagnostics) = found.remove(&path) else {
                continue;
            };
            let known = self
                .told
                .get(&path)
                .is_some_and(|(_, before)| *before == diagnostics);
            if !known {
                self.tell(uri.clone(), Some(version), diagnostics.clone());
                self.told.insert(path, (uri, diagnostics));
            }
        }
    }

    fn tell(&self, uri: Uri, version: Option<i32>, diagnostics: Vec<Diagnostic>) {
        let params = PublishDiagnosticsParams {
            uri,
            diagnostics,
            version,
        };
        self.notify("textDocument/publishDiagnostics", params);
    }

    /// The mistakes of the open documents; each project is checked once.
    fn diagnostics(&self) -> BTreeMap<PathBuf, Vec<Diagnostic>> {
        let mut found: BTreeMap<PathBuf, Vec<Diagnostic>> = BTreeMap::new();
        for (path, _) in self.documents.iter() {
            match kind(path) {
                _ if found.contains_key(path) => {}
                Some(Kind::StructuredText) => {
                    for (file, diagnostics) in self.project(path).diagnostics() {
                        // Another project may contain this file, too; the project of an open document has
                        // priority.
                        found.entry(file).or_insert(diagnostics);
                    }
                }
                Some(Kind::Script) => {
                    found.insert(path.clone(), script::diagnostics(&self.documents, path));
                }
                None => {}
            }
        }
        found.retain(|path, _| self.documents.iter().any(|(open, _)| open == path));
        found
    }
}

fn parameters<T: DeserializeOwned>(params: Value) -> Result<T, Refusal> {
    serde_json::from_value(params).map_err(|error| (ErrorCode::InvalidParams, error.to_string()))
}

fn capabilities() -> ServerCapabilities {
    let signs = [".", "#", "\"", "(", "="];
    ServerCapabilities {
        text_document_sync: Some(TextDocumentSyncCapability::Kind(TextDocumentSyncKind::FULL)),
        hover_provider: Some(HoverProviderCapability::Simple(true)),
        definition_provider: Some(OneOf::Left(true)),
        completion_provider: Some(CompletionOptions {
            trigger_characters: Some(signs.map(str::to_owned).to_vec()),
            ..CompletionOptions::default()
        }),
        document_formatting_provider: Some(OneOf::Left(true)),
        ..ServerCapabilities::default()
    }
}
