# SPDX-License-Identifier: MIT
"""Is a .glb file what glTF 2.0 asks for? gltf.py FILE prints one JSON object, or says what is wrong and exits with 1.

Checked: header and chunks, every index within its list, every accessor within its view and aligned, minima and maxima,
indices below the number of corners, unit normals and quaternions, times that grow, channels that are unique.
"""
import json
import struct
import sys

SIZES = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4}
CODES = {5121: "B", 5123: "H", 5125: "I", 5126: "f"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


def fail(text):
    print(text, file=sys.stderr)
    sys.exit(1)


def need(condition, text):
    if not condition:
        fail(text)


def chunks(data):
    need(len(data) >= 12, "shorter than its header")
    magic, version, length = struct.unpack_from("<4sII", data)
    need(magic == b"glTF" and version == 2, "no glTF 2")
    need(length == len(data), f"says {length} bytes, has {len(data)}")
    at, found = 12, []
    while at < length:
        size, kind = struct.unpack_from("<I4s", data, at)
        need(size % 4 == 0 and at + 8 + size <= length, "a chunk that is cut off or not aligned")
        found.append((kind, data[at + 8:at + 8 + size]))
        at += 8 + size
    need([kind for kind, _ in found] == [b"JSON", b"BIN\0"], "other chunks than JSON and BIN")
    return json.loads(found[0][1].decode("utf-8")), found[1][1]


class File:
    def __init__(self, name):
        self.tree, self.binary = chunks(open(name, "rb").read())
        need(self.tree["asset"]["version"] == "2.0", "no version")
        need(len(self.tree["buffers"]) == 1 and self.tree["buffers"][0]["byteLength"] <= len(self.binary) <
             self.tree["buffers"][0]["byteLength"] + 4, "another length of the buffer")

    def view(self, number):
        view = self.tree["bufferViews"][number]
        need(view["buffer"] == 0 and view["byteOffset"] % 4 == 0 and
             view["byteOffset"] + view["byteLength"] <= len(self.binary), f"view {number} is not in the buffer")
        return view

    def values(self, number):
        a = self.tree["accessors"][number]
        view = self.view(a["bufferView"])
        size, width = SIZES[a["componentType"]], WIDTHS[a["type"]]
        stride = view.get("byteStride", size * width)
        need(a["count"] >= 1 and a["byteOffset"] % size == 0 and stride % 4 == 0, f"accessor {number} is not aligned")
        need(a["byteOffset"] + stride * (a["count"] - 1) + size * width <= view["byteLength"],
             f"accessor {number} is not within its view")
        code = f"<{width}{CODES[a['componentType']]}"
        first = view["byteOffset"] + a["byteOffset"]
        rows = [struct.unpack_from(code, self.binary, first + stride * k) for k in range(a["count"])]
        for name, function in (("min", min), ("max", max)):
            if name in a:
                found = [function(row[k] for row in rows) for k in range(width)]
                need(found == a[name], f"accessor {number}: {name} is {found}, not {a[name]}")
        return rows

    def unit(self, rows, what):
        for row in rows:
            need(abs(sum(x * x for x in row) - 1) < 1e-4, f"{what} of another length: {row}")

    def mesh(self, mesh):
        for primitive in mesh["primitives"]:
            need(primitive["material"] < len(self.tree["materials"]), "no such material")
            a = primitive["attributes"]
            need("min" in self.tree["accessors"][a["POSITION"]], "positions without bounds")
            positions, normals, colours = (self.values(a[n]) for n in ("POSITION", "NORMAL", "COLOR_0"))
            need(len(positions) == len(normals) == len(colours), "lists of different lengths")
            self.unit(normals, "a normal")
            need(all(0 <= x <= 1 for row in colours for x in row), "a colour out of range")
            indices = [row[0] for row in self.values(primitive["indices"])]
            need(max(indices) < len(positions), "an index out of range")
            volume = 0
            if primitive.get("mode", 4) == 3:  # a line, along z
                need(positions[0] == (0, 0, 0) and positions[-1] == (0, 0, 1), "a line from elsewhere to elsewhere")
                continue
            need(primitive.get("mode", 4) == 4 and len(indices) % 3 == 0, "neither triangles nor a line")
            for k in range(0, len(indices), 3):
                a, b, c = (positions[i] for i in indices[k:k + 3])
                u = [b[i] - a[i] for i in range(3)]
                v = [c[i] - a[i] for i in range(3)]
                n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
                need(sum(n[i] * normals[indices[k]][i] for i in range(3)) > 0, "a triangle that faces inwards")
                volume += sum(a[i] * n[i] for i in range(3)) / 6
            yield volume

    def animation(self, animation):
        targets = set()
        for channel in animation["channels"]:
            target = (channel["target"]["node"], channel["target"]["path"])
            need(target not in targets and target[0] < len(self.tree["nodes"]), "a target twice, or none")
            targets.add(target)
            sampler = animation["samplers"][channel["sampler"]]
            times = [row[0] for row in self.values(sampler["input"])]
            need("min" in self.tree["accessors"][sampler["input"]], "times without bounds")
            need(all(a < b for a, b in zip(times, times[1:])), "times that do not grow")
            rows = self.values(sampler["output"])
            need(len(rows) == len(times), "more or fewer values than times")
            if target[1] == "rotation":
                self.unit(rows, "a rotation")
                need(all(sum(x * y for x, y in zip(a, b)) >= 0 for a, b in zip(rows, rows[1:])), "a turn the long way")
            yield self.tree["nodes"][target[0]]["name"], target[1], times, rows


def main():
    file = File(sys.argv[1])
    tree = file.tree
    seen = [False] * len(tree["nodes"])
    for number in tree["scenes"][tree["scene"]]["nodes"]:
        todo = [number]
        while todo:
            node = todo.pop()
            need(not seen[node], "a node with two parents")
            seen[node] = True
            todo += tree["nodes"][node].get("children", [])
    need(all(seen), "a node that is in no scene")
    volumes = [sum(file.mesh(mesh)) for mesh in tree["meshes"]]
    for node in tree["nodes"]:
        need(node.get("mesh", 0) < len(tree["meshes"]), "no such mesh")
        if "rotation" in node:
            file.unit([node["rotation"]], "a rotation")
    tracks = {}
    for animation in tree.get("animations", []):
        for name, path, times, rows in file.animation(animation):
            tracks[f"{name}.{path}"] = {"times": [times[0], times[-1]], "count": len(times), "last": rows[-1], "rows": rows}
    names = [node["name"] for node in tree["nodes"]]
    print(json.dumps({"nodes": names, "tracks": tracks,
                      "volumes": {node["name"]: volumes[node["mesh"]] for node in tree["nodes"] if "mesh" in node}}))


main()
