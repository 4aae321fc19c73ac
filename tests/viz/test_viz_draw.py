"""Pictures: what is in them, and that the same input gives the same bytes."""

import subprocess
import sys
import types

import numpy as np
import pytest

import csgmesh as cm
from csgmesh.viz import notebook


@pytest.fixture(scope="module")
def rock():
    block = cm.Box((0, 0), (3, 3), name="block")
    regions = cm.Regions({"rock": block, "core": cm.Disk((1.5, 1.5), 0.8, name="inclusion")})
    crack = cm.EmbeddedPath([(0.3, 0.3), (1.0, 0.4)], name="crack")
    return cm.Embed(regions, [crack, cm.EmbeddedPoints([(2.7, 2.7)], name="probe")])


@pytest.fixture(scope="module")
def square():
    n = 12
    x, y = np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1), indexing="ij")
    i, j = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    a = (i * (n + 1) + j).ravel()
    cells = np.concatenate(
        [np.column_stack([a, a + n + 1, a + n + 2]), np.column_stack([a, a + n + 2, a + 1])]
    )
    return cm.Mesh(np.column_stack([x.ravel(), y.ravel()]), {"triangle": cells})


NAMES = ["rock", "core", "block.left", "block.top", "inclusion", "crack", "probe"]


@pytest.mark.parametrize("make", [lambda x: x, cm.evaluate], ids=["shape", "pslg"])
def test_svg_names_everything(tmp_path, rock, make):
    cm.draw(make(rock), tmp_path / "a.svg")
    text = (tmp_path / "a.svg").read_text()
    for name in NAMES:
        assert f"<!-- {name} -->" in text


def test_mesh_picture_names_everything(tmp_path):
    points = [[0, 0], [1, 0], [1, 1], [0, 1]]
    mesh = cm.Mesh(
        points,
        {"quad": [[0, 1, 2, 3]]},
        facets={"line": [[0, 1], [1, 2], [2, 3], [3, 0]]},
        facet_marker={"line": [0, 1, 0, -1]},
        boundary_names=[("_wall", "cost $5$"), ("door",), ("unused",)],
    )
    legend = cm.draw(mesh).axes[0].get_legend()
    # A leading "_" or a "$" means something to matplotlib, but not in a name.
    assert [t.get_text() for t in legend.get_texts()] == ["_wall, cost $5$", "door"]
    cm.draw(mesh, tmp_path / "a.png")
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
    cm.draw(mesh, tmp_path / "a.pdf")
    assert (tmp_path / "a.pdf").read_bytes().startswith(b"%PDF")


@pytest.mark.parametrize("suffix", [".svg", ".png", ".pdf"])
def test_the_same_picture_gives_the_same_bytes(tmp_path, square, suffix):
    cm.draw(square, tmp_path / f"a{suffix}")
    cm.draw(square, tmp_path / f"b{suffix}")
    assert (tmp_path / f"a{suffix}").read_bytes() == (tmp_path / f"b{suffix}").read_bytes()


def test_a_hole_is_not_filled_and_a_region_is():
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    plate = cm.Box((0, 0), (2, 2)) - cm.Disk((1, 1), 0.5)
    figure = cm.draw(plate, legend=False)
    figure.canvas.draw()
    assert isinstance(figure.canvas, FigureCanvasAgg)
    pixels = np.asarray(figure.canvas.buffer_rgba())

    def color(x, y):
        column, row = figure.axes[0].transData.transform((x, y))
        return tuple(pixels[len(pixels) - 1 - int(row), int(column), :3].tolist())

    assert color(1, 1) == (255, 255, 255)
    assert color(0.2, 0.2) == (0xD7, 0xE5, 0xF2) == color(1, 0.4)


def test_curves_are_drawn_through_their_exact_points(rock):
    domain = cm.evaluate(cm.Disk((0, 0), 1), deviation=0.2)
    assert len(domain.segments) < 12
    figure = cm.draw(domain)
    lines = np.concatenate(figure.axes[0].collections[0].get_segments())
    np.testing.assert_allclose(np.hypot(*lines.T), 1, atol=1e-12)
    assert len(lines) > 5 * len(domain.segments)


def test_many_names_are_capped():
    shape = cm.union([cm.Disk((3 * i, 0), 1, name=f"d{i}") for i in range(40)])
    texts = [t.get_text() for t in cm.draw(shape).axes[0].get_legend().get_texts()]
    assert texts[:2] == ["d0", "d1"] and texts[-1] == "… and 18 more" and len(texts) == 23
    assert cm.draw(shape, legend=False).axes[0].get_legend() is None


def test_dense_meshes_stay_small_in_svg(tmp_path):
    n = 150
    x, y = np.meshgrid(np.arange(n + 1.0), np.arange(n + 1.0), indexing="ij")
    i, j = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    a = (i * (n + 1) + j).ravel()
    cells = {"quad": np.column_stack([a, a + n + 1, a + n + 2, a + 1])}
    cm.draw(cm.Mesh(np.column_stack([x.ravel(), y.ravel()]), cells), tmp_path / "a.svg")
    assert (tmp_path / "a.svg").stat().st_size < 2e6


def test_smallest_angles_have_a_scale(square):
    figure = cm.draw(square, color="min_angle", title="quality")
    assert [axes.get_ylabel() for axes in figure.axes] == ["", "smallest angle (degrees)"]
    assert figure.axes[0].get_title() == "quality"
    from csgmesh.viz.drawing import min_angles
    from csgmesh.viz.scene import mesh_scene

    np.testing.assert_allclose(min_angles(mesh_scene(square)), 45)


def test_axes_of_the_caller_are_used(square):
    from matplotlib.figure import Figure

    figure = Figure()
    axes = figure.add_subplot()
    assert cm.draw(square, ax=axes) is figure
    assert axes.get_title() == "288 triangles, 169 points"


def test_matplotlib_state_is_left_alone(square, tmp_path):
    import matplotlib as mpl

    before = dict(mpl.rcParams)
    cm.draw(square, tmp_path / "a.svg")
    assert dict(mpl.rcParams) == before
    assert "matplotlib.pyplot" not in sys.modules or not mpl.pyplot.get_fignums()


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"colour": "region"}, "draw has no option 'colour'; did you mean 'color'"),
        (
            {"color": "size"},
            "color must be one of 'region', 'min_angle', 'min_dihedral', 'scaled_jacobian'",
        ),
        ({"figsize": (4, 0)}, "figsize must be two positive lengths"),
        ({"dpi": 0}, "dpi must be"),
    ],
)
def test_bad_options(square, options, said):
    with pytest.raises(cm.InputError, match=said):
        cm.draw(square, **options)


def test_bad_input(tmp_path, square):
    with pytest.raises(cm.InputError, match="draw knows shapes, Pslg, Plc and Mesh; got str"):
        cm.draw("plate")
    with pytest.raises(cm.InputError, match="needs a Mesh; got Disk"):
        cm.draw(cm.Disk((0, 0), 1), color="min_angle")
    with pytest.raises(
        cm.FileFormatError, match=r"\.png, \.svg or \.pdf; got '\.pgn'; did you mean"
    ):
        cm.draw(square, tmp_path / "a.pgn")
    with pytest.raises(cm.FileFormatError, match="there is no directory"):
        cm.draw(square, tmp_path / "no" / "a.png")


class FakeFormatter:
    """As much of IPython's formatter as is needed."""

    def __init__(self):
        self.found = {}

    def for_type_by_name(self, module, name, function):
        self.found[module, name] = function


def test_notebooks_show_svg(monkeypatch, rock, square):
    svg = FakeFormatter()
    display = types.SimpleNamespace(formatters={"image/svg+xml": svg})
    shell = types.SimpleNamespace(display_formatter=display)
    # matplotlib asks a loaded IPython for its version.
    fake = types.SimpleNamespace(get_ipython=lambda: shell, version_info=(9, 0))
    monkeypatch.setitem(sys.modules, "IPython", fake)
    assert notebook.register_if_active()
    for x in (rock, rock.shape, cm.Disk((0, 0), 1), cm.evaluate(cm.Disk((0, 0), 1)), square):
        keys = [(c.__module__, c.__name__) for c in type(x).__mro__]
        show = next(svg.found[key] for key in keys if key in svg.found)
        assert "<svg" in show(x)
    # Nothing to show is shown as text, not as a traceback.
    assert show(cm.HalfSpace((0, 0), (1, 0))) is None
    assert "<svg" in cm.draw(square)._repr_svg_()


def test_without_a_notebook_nothing_happens(monkeypatch):
    monkeypatch.setitem(sys.modules, "IPython", types.SimpleNamespace(get_ipython=lambda: None))
    assert not notebook.register_if_active()
    monkeypatch.delitem(sys.modules, "IPython")
    assert not notebook.register_if_active()


def test_importing_into_a_notebook_is_enough():
    script = """
import sys, types
found = []
svg = types.SimpleNamespace(for_type_by_name=lambda module, name, function: found.append(name))
display = types.SimpleNamespace(formatters={"image/svg+xml": svg})
shell = types.SimpleNamespace(display_formatter=display)
sys.modules["IPython"] = types.SimpleNamespace(get_ipython=lambda: shell)
import csgmesh
print(*sorted(found), "matplotlib" in sys.modules)
"""
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert run.stdout.split() == [
        *("Embed", "Mesh", "Periodic", "Plc", "Pslg", "Regions", "Shape", "False")
    ]


def test_edges_are_drawn_though_most_cells_crowd_in_a_corner():
    from csgmesh.viz.paint import edge_width
    from csgmesh.viz.scene import mesh_scene

    mesh = cm.generate(cm.Box((0, 0), (1, 1)) - cm.Disk((0.5, 0.5), 1e-7))
    assert edge_width(mesh_scene(mesh), 500.0) > 0
