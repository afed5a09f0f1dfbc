"""Asks `standstill mcp` for everything it offers, with the client of the Python package `mcp`."""

import asyncio
import json
import sys
import tempfile
from pathlib import Path

from mcp import ClientSession, StdioServerParameters
from mcp.client.stdio import stdio_client

PROGRAM = str(Path(sys.argv[1]).resolve())
SCRIPT = Path("scan-tests/tutorial/slide.scan.json")


async def main():
    with tempfile.TemporaryDirectory() as out:
        server = StdioServerParameters(command=PROGRAM, args=["mcp", "scan-tests", "--write", out])
        async with stdio_client(server) as (read, write), ClientSession(read, write) as session:
            begun = await session.initialize()
            assert begun.server_info.name == "standstill", begun
            tools = {tool.name: tool for tool in (await session.list_tools()).tools}
            assert list(tools) == ["check", "run", "explain", "plan", "blocks", "errors"], tools

            async def call(tool, arguments, fails=False):
                result = await session.call_tool(tool, arguments)
                assert result.is_error == fails, (tool, arguments, result)
                return result.structured_content or result.content[0].text

            checked = await call("check", {"path": "tutorial", "strict": True})
            assert checked["passed"] and len(checked["scripts"]) == 2, checked
            run = await call("run", {"path": "tutorial/slide.scan.json", "signals": ["X.Position"], "every": 100, "report": "slide.html"})
            assert run["rows"]["columns"] == ["scan", "X.Position"] and len(run["rows"]["rows"]) == 4, run
            assert "</html>" in (Path(out) / "slide.html").read_text()
            script = json.loads(SCRIPT.read_text())
            script["blocks"][0]["type"] = "MC_Powr"
            wrong = await call("check", {"script": script})
            assert "MC_Power" in wrong["scripts"][0]["error"], wrong
            story = await call("explain", {"expected": "tutorial/slide.scan.json", "found": "tutorial/abort.scan.json"})
            assert not story["passed"] and story["story"]["causes"], story
            line = {"Ts": 0.001, "target": 0.02, "limits": {"velocity": 1, "acceleration": 20, "jerk": 2000}}
            planned = await call("plan", {"lines": [line]})
            assert planned["answers"][0]["scans"] == 75, planned
            blocks = await call("blocks", {"names": ["MC_TouchProbe"]})
            assert blocks["blocks"][0]["name"] == "MC_TouchProbe", blocks
            assert "MC_Power" in await call("errors", {"error": 201})
            assert "outside the folder" in await call("run", {"path": "../README.md"}, fails=True)
    print(f"{len(tools)} tools answer the client of the Python package mcp")


asyncio.run(main())
