"""A small network written as ONNX by hand: the tests need no exporter."""

import numpy as np

SIDE = 1024
TYPES = {"float32": 1, "int64": 7}


def _number(value):
    found = b""
    while value > 127:
        found, value = found + bytes([value & 127 | 128]), value >> 7
    return found + bytes([value])


def _field(number, value):
    """One field of a protocol buffer."""
    if isinstance(value, int):
        return _number(number << 3) + _number(value)
    content = value.encode() if isinstance(value, str) else value
    return _number(number << 3 | 2) + _number(len(content)) + content


def weight(name, value):
    array = np.asarray(value)
    sizes = b"".join(_field(1, size) for size in array.shape)
    return sizes + _field(2, TYPES[array.dtype.name]) + _field(8, name) + _field(9, array.tobytes())


def tensor(name, *shape):
    sizes = b"".join(_field(1, _field(1, size)) for size in shape)
    return _field(1, name) + _field(2, _field(1, _field(1, 1) + _field(2, sizes)))


def node(kind, inputs, output, **attributes):
    found = b"".join(_field(1, name) for name in inputs) + _field(2, output) + _field(4, kind)
    for name, value in attributes.items():
        several = isinstance(value, list)
        content = b"".join(_field(8, one) for one in value) if several else _field(3, value)
        found += _field(5, _field(1, name) + content + _field(20, 7 if several else 2))
    return found


def network(nodes, inputs, outputs, weights):
    graph = b"".join(_field(1, part) for part in nodes) + _field(2, "test")
    for number, parts in ((5, weights), (11, inputs), (12, outputs)):
        graph += b"".join(_field(number, part) for part in parts)
    return _field(1, 7) + _field(7, graph) + _field(8, _field(1, "") + _field(2, 13))


def promptable(masks="output_masks", scores=(0.1, 0.7, 0.9)):
    """A network with EfficientSAM's interface that answers with three masks: all, what is dark, what is dark right of
    the mean of the points.
    """
    ramp = (np.arange(SIDE, dtype=np.float32) / SIDE).reshape(1, 1, 1, 1, SIDE)
    nodes = [
        node("ReduceMean", ["batched_images"], "grey", axes=[1], keepdims=1),
        node("Sub", ["half", "grey"], "darkness"),
        node("Reshape", ["darkness", "one mask"], "dark"),
        node("ReduceMax", ["batched_point_coords"], "farthest", axes=[2, 3], keepdims=0),
        node("Mul", ["farthest", "per side"], "share"),
        node("Reshape", ["share", "one number"], "reach"),
        node("Sub", ["reach", "ramp"], "left"),
        node("Mul", ["left", "steep"], "wall"),
        node("Min", ["dark", "wall"], "dark left"),
        node("Abs", ["dark"], "all"),
        node("Concat", ["all", "dark", "dark left"], masks, axis=2),
        node("ReduceMax", ["batched_point_labels"], "label", axes=[2, 3], keepdims=0),
        node("Reshape", ["label", "one score"], "label again"),
        node("Mul", ["label again", "nothing"], "zero"),
        node("Add", ["zero", "scores"], "iou_predictions"),
    ]
    weights = [
        weight("half", np.float32([0.5])),
        weight("one mask", np.int64([1, 1, 1, SIDE, SIDE])),
        weight("per side", np.float32([1 / SIDE])),
        weight("one number", np.int64([1, 1, 1, 1, 1])),
        weight("ramp", np.broadcast_to(ramp, (1, 1, 1, SIDE, SIDE)).copy()),
        weight("steep", np.float32([100])),
        weight("one score", np.int64([1, 1, 1])),
        weight("nothing", np.float32([0])),
        weight("scores", np.float32([[scores]])),
    ]
    inputs = [
        tensor("batched_images", 1, 3, SIDE, SIDE),
        tensor("batched_point_coords", 1, 1, 6, 2),
        tensor("batched_point_labels", 1, 1, 6, 1),
    ]
    outputs = [tensor(masks, 1, 1, 3, SIDE, SIDE), tensor("iou_predictions", 1, 1, 3)]
    return network(nodes, inputs, outputs, weights)
