"""From a tree in the plane to its exact, named boundary.

1. Every leaf gives its boundary as monotone curve pieces (`pieces`).
2. Pieces are cut where they meet, coincident ones become one (`intersections`, `arrangement`).
3. The order of edges around vertices gives the faces (`rotation`).
4. Winding numbers say which leaves cover a face, the tree which region it is (`classification`).
5. Edges between different regions become chains of a curve (`chains`), then chords (`flattening`).

Topology is settled in step 3, before anything is flattened: a sliver thinner than the chord error
is as safe as a square.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from csgmesh.boundary.arrangement import Arrangement, arrange
from csgmesh.boundary.chains import Chains, chains
from csgmesh.boundary.classification import face_regions
from csgmesh.boundary.flattening import Chords, flatten
from csgmesh.boundary.pieces import default_snap, gather, working_frame
from csgmesh.boundary.rotation import planar_map
from csgmesh.csg.program import Program, compile_shape
from csgmesh.domain.pslg import Pslg
from csgmesh.domain.report import Merge, Report
from csgmesh.errors import ShapeError


def evaluate_plane(shape: Any, deviation: float | None, snap: float | None) -> Pslg:
    """The boundary of a plane shape; see `csgmesh.evaluate`."""
    program = compile_shape(shape)
    frame = working_frame(program)
    user_snap = default_snap(frame, snap)
    local_snap = user_snap / frame.scale
    pieces = gather(program, frame)
    probes = [np.asarray(p, float).reshape(-1, 2) for _, p in program.probes]
    cloud = np.concatenate([np.zeros((0, 2)), *probes])
    arrangement = arrange(pieces, frame, (cloud - frame.centre) / frame.scale, local_snap)
    _, face = planar_map(arrangement, local_snap)
    region = face_regions(program, arrangement, face)
    kept = chains(program, arrangement, face, region)
    _refuse_lost_paths(program, kept)
    chords = flatten(arrangement, kept, deviation, local_snap)
    probe_marker, names = _probe_markers(program, kept.names, [len(p) for p in probes])
    return _pslg(
        program, arrangement, kept, chords, probe_marker, names,
        deviation=deviation, snap=user_snap,
    )  # fmt: skip


def _probe_markers(
    program: Program, names: tuple[tuple[str, ...], ...], counts: list[int]
) -> tuple[np.ndarray, tuple[tuple[str, ...], ...]]:
    table = {name: k for k, name in enumerate(names)}
    marker = [table.setdefault((name,), len(table)) for name, _ in program.probes]
    return np.repeat(np.array(marker, np.int64), counts), tuple(table)


def _pslg(
    program: Program,
    arrangement: Arrangement,
    kept: Chains,
    chords: Chords,
    probe_marker: np.ndarray,
    names: tuple[tuple[str, ...], ...],
    *,
    deviation: float | None,
    snap: float,
) -> Pslg:
    left, right = kept.left[chords.chain], kept.right[chords.chain]
    # The domain on the left of its outer boundary, the lower region on the left of an interface.
    turn = (left < 0) | ((right >= 0) & (right < left))
    segments = np.column_stack([chords.tail, chords.head])
    interval = np.column_stack([chords.t0, chords.t1])
    segments[turn], interval[turn] = segments[turn, ::-1], interval[turn, ::-1]
    sides = np.column_stack([left, right])
    sides[turn] = sides[turn, ::-1]
    used, number = np.unique(
        np.concatenate([segments.ravel(), arrangement.probe_vertex]), return_inverse=True
    )
    points = chords.points[used]
    # Those on the boundary belong to the domain, whatever rounding says of their membership.
    probe = number[segments.size :]
    inner = np.flatnonzero(~np.isin(probe, number[: segments.size]))
    _refuse_outside(program, points[probe[inner]], probe_marker[inner], names)
    point_marker = np.full(len(used), -1)
    point_marker[number[segments.size :]] = probe_marker
    curves, curve = np.unique(kept.source, return_inverse=True)
    pieces = arrangement.pieces
    interval_of = np.column_stack([np.full(len(curves), np.inf), np.full(len(curves), -np.inf)])
    np.minimum.at(interval_of[:, 0], curve, kept.t0)
    np.maximum.at(interval_of[:, 1], curve, kept.t1)
    table = pieces.curves[curves]
    promised = deviation if deviation is not None else _largest_sag(pieces, kept, chords)
    return Pslg.build(
        points=points,
        segments=number[: segments.size].reshape(-1, 2),
        segment_curve=curve[chords.chain],
        segment_interval=interval,
        segment_marker=kept.marker[chords.chain],
        segment_region=sides,
        point_marker=point_marker,
        boundary_names=names,
        region_names=tuple(name for name, _ in program.regions),
        curves=type(table)(table.kind, table.data, interval_of),
        deviation=float(promised),
        snap=snap,
        report=_report(program, arrangement),
        oracle=program,
    )


def _largest_sag(pieces: Any, kept: Chains, chords: Chords) -> float:
    bend = pieces.curves.second_derivative_bounds()[kept.source[chords.chain]]
    return float(((chords.t1 - chords.t0) ** 2 * bend / 8).max(initial=0.0))


def _refuse_lost_paths(program: Program, kept: Chains) -> None:
    if not program.paths:
        return
    found = {name for marker in np.unique(kept.marker).tolist() for name in kept.names[marker]}
    for name, points in program.paths:
        if name not in found:
            x, y = points[0]
            raise ShapeError(
                f"embedded path {name!r} from ({x:.6g}, {y:.6g}) lies outside the domain all along"
            )


def _refuse_outside(
    program: Program,
    points: np.ndarray,
    marker: np.ndarray,
    names: tuple[tuple[str, ...], ...],
) -> None:
    if len(points) == 0:
        return
    outside = np.flatnonzero(program.region(points) < 0)
    if len(outside):
        x, y = points[outside[0]]
        name = names[marker[outside[0]]][0]
        raise ShapeError(f"embedded point ({x:.6g}, {y:.6g}) of {name!r} lies outside the domain")


def _report(program: Program, arrangement: Arrangement) -> Report:
    merged = arrangement.merged
    labels = [leaf.label for leaf in program.leaves] + ["working frame"]
    labels += [f"embedded path {name!r}" for name, _ in program.paths]
    leaf = arrangement.pieces.leaf
    merges = []
    for k in range(min(len(merged.distance), Report.LISTED)):
        through = sorted(merged.piece[k].tolist(), key=lambda p: leaf[p] if p >= 0 else len(labels))
        owners = [labels[leaf[p]] if p >= 0 else "embedded point" for p in through]
        merges.append(
            Merge(
                tuple(merged.place[k].tolist()),
                float(merged.distance[k]),
                tuple(dict.fromkeys(owners)),
            )
        )
    largest = float(merged.distance.max(initial=0.0))
    return Report(tuple(merges), len(merged.distance), largest)
