//! `standstill mcp`: the tools for an agent, over the Model Context Protocol on standard input and
//! output.
//!
//! Every call that runs files is a process of this program, with limits on its time, its memory and the
//! length of its answer ([`bounded`]). It works in one folder and writes only into the folder that was
//! named for it ([`place`]).

#[cfg(any(unix, windows))]
mod bounded;
#[cfg(any(unix, windows))]
mod line;
#[cfg(any(unix, windows))]
mod place;
#[cfg(any(unix, windows))]
mod rows;
#[cfg(any(unix, windows))]
mod tools;

/// The replacement on systems on which no program can be started.
#[cfg(not(any(unix, windows)))]
pub fn mcp(_: &crate::args::McpArguments) -> Result<crate::exit::Exit, crate::exit::Failure> {
    Err(crate::exit::Failure::usage(
        "mcp is unsupported on this system: it needs one that starts programs",
    ))
}

#[cfg(any(unix, windows))]
pub use door::mcp;

#[cfg(any(unix, windows))]
mod door {
    use super::line::Bounded;
    use super::place::Place;
    use super::tools::{self, Answer};
    use crate::args::McpArguments;
    use crate::exit::{Exit, Failure};
    use crate::limit;
    use rmcp::model::{
        CallToolRequestParams, CallToolResponse, CallToolResult, ContentBlock, Implementation,
        ListToolsResult, PaginatedRequestParams, ServerCapabilities, ServerConfig,
    };
    use rmcp::service::{RequestContext, RoleServer, ServerInitializeError, ServiceExt as _};
    use rmcp::{ErrorData, ServerHandler};
    use serde_json::Value;
    use std::io;
    use tokio::sync::Semaphore;

    /// Calls that run at the same time; others wait for their turn.
    const AT_A_TIME: usize = 2;

    /// The description of the server for a client.
    const INSTRUCTIONS: &str = "standstill runs PLCopen motion without hardware: scan scripts (*.scan.json) drive function \
blocks and axes scan by scan, their claims say what must come of it. Begin with `blocks` for the pins of a block, \
`check` a script (as text or by its path) for mistakes, claims and goldens, `run` it to see signals, `errors` for what an ErrorID \
means, `explain` for where two runs part, `plan` for single moves.";

    struct Door {
        place: Place,
        turns: Semaphore,
    }

    /// Answers a client until it disconnects.
    pub fn mcp(arguments: &McpArguments) -> Result<Exit, Failure> {
        let place = Place::new(arguments)?;
        let system = |error: io::Error| Failure::io("mcp", &error);
        let mut runtime = tokio::runtime::Builder::new_current_thread();
        let runtime = runtime.enable_all().build().map_err(system)?;
        limit::doing("serving a client");
        let door = Door {
            place,
            turns: Semaphore::new(AT_A_TIME),
        };
        let ended = runtime.block_on(async {
            let streams = (Bounded::new(tokio::io::stdin()), tokio::io::stdout());
            let client = match door.serve(streams).await {
                Ok(client) => client,
                // It disconnected before its first message.
                Err(ServerInitializeError::ConnectionClosed(_)) => return Ok(Exit::Passed),
                Err(error) => {
                    let text = format!("error: mcp: the client did not begin as the protocol says: {error}");
                    return Err(Failure::Told(Exit::Io, text));
                }
            };
            match client.waiting().await {
                Ok(_) => Ok(Exit::Passed),
                Err(error) => Err(Failure::Told(Exit::Internal, format!("error: mcp: {error}"))),
            }
        });
        // A pending read of standard input delays nothing.
        runtime.shutdown_background();
        ended
    }

    impl ServerHandler for Door {
        fn get_info(&self) -> ServerConfig {
            ServerConfig::new(ServerCapabilities::builder().enable_tools().build())
                .with_server_info(Implementation::new("standstill", env!("CARGO_PKG_VERSION")))
                .with_instructions(INSTRUCTIONS)
        }

        async fn list_tools(
            &self,
            _: Option<PaginatedRequestParams>,
            _: RequestContext<RoleServer>,
        ) -> Result<ListToolsResult, ErrorData> {
            Ok(ListToolsResult::with_all_items(tools::all(&self.place)))
        }

        async fn call_tool(
            &self,
            request: CallToolRequestParams,
            context: RequestContext<RoleServer>,
        ) -> Result<CallToolResponse, ErrorData> {
            let arguments = Value::Object(request.arguments.unwrap_or_default());
            let work = async {
                // The semaphore is never closed.
                let _turn = self.turns.acquire().await;
                tools::call(&request.name, arguments, &self.place).await
            };
            // Dropping a future here ends its process.
            let answer = tokio::select! {
                answer = work => answer,
                () = context.ct.cancelled() => Err("the client has cancelled this call".to_owned()),
            };
            let result = match answer {
                Ok(Answer::Text(text)) => CallToolResult::success(vec![ContentBlock::text(text)]),
                Ok(Answer::Json(value)) => CallToolResult::structured(value),
                Err(text) => CallToolResult::error(vec![ContentBlock::text(text)]),
            };
            Ok(result.into())
        }
    }
}
