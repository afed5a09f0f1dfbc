"""Commands the axis over OPC UA and holds what it sees: drive_axis.py ENDPOINT. Needs the package asyncua."""

import asyncio
import sys

from asyncua import Client, ua

TARGET = 30.0  # mm
SPEED = 50.0  # mm/s


async def nodes(client):
    """All variables of the server's own namespaces, by their browse name."""
    found = {}
    waiting = [client.nodes.objects]
    while waiting:
        for child in await waiting.pop().get_children():
            if child.nodeid.NamespaceIndex == 0:
                continue
            if await child.read_node_class() == ua.NodeClass.Variable:
                found[(await child.read_browse_name()).Name] = child
            waiting.append(child)
    return found


def pick(found, name):
    """The one variable whose name ends so."""
    fitting = [node for full, node in found.items() if full == name or full.endswith("." + name)]
    assert len(fitting) == 1, (name, sorted(found))
    return fitting[0]


async def until(node, holds, what):
    for _ in range(1000):
        value = await node.read_value()
        if holds(value):
            return value
        await asyncio.sleep(0.01)
    raise SystemExit(f"not within 10 s: {what}, it is {value}")


async def main(endpoint):
    async with Client(endpoint) as client:
        found = await nodes(client)
        names = ["enable", "execute", "target", "speed", "position", "velocity", "powered", "done", "error_id"]
        axis = {name: pick(found, name) for name in names}

        async def write(name, value):
            await axis[name].write_value(ua.DataValue(ua.Variant(float(value), ua.VariantType.Double)))

        assert await axis["position"].read_value() == 0.0
        await write("enable", 1)
        await until(axis["powered"], lambda value: value == 1.0, "MC_Power.Status")
        await write("target", TARGET)
        await write("speed", SPEED)
        await write("execute", 1)
        seen = await until(axis["velocity"], lambda value: value > 0.0, "motion")
        between = await until(axis["position"], lambda value: 0.0 < value < TARGET, "a position on the way")
        await until(axis["done"], lambda value: value == 1.0, "MC_MoveAbsolute.Done")
        position = await axis["position"].read_value()
        assert position == TARGET, position
        assert await axis["error_id"].read_value() == 0.0
        await write("execute", 0)
        await write("enable", 0)
        await until(axis["powered"], lambda value: value == 0.0, "power off")
        print(f"moved: seen at {between:.3f} mm with {seen:.3f} mm/s, done at {position} mm, and off")


asyncio.run(main(sys.argv[1]))
