"""What innermap has, with types; docstrings are the module's own (help(innermap.fit))."""
import builtins
from os import PathLike
from typing import (
    Any, Callable, Dict, Iterator, List, Literal, Mapping, Optional, Sequence, Tuple, Union, overload)

import numpy
from numpy.typing import ArrayLike, NDArray

Array = NDArray[Any]
Floats = NDArray[numpy.float64]
Ints = NDArray[numpy.int32]
Bools = NDArray[numpy.bool_]
Path = Union[str, PathLike[str]]
# A mesh as one argument; V, F are two. Objects with points and cells, such as meshio.Mesh, are Any.
AnyMesh = Any
Progress = Callable[[str, float], object]
Place = Union[int, ArrayLike]
Triangles = Union[str, ArrayLike]
GroupValues = Union[Mapping[str, ArrayLike], Sequence[Tuple[Triangles, ArrayLike]]]

__version__: str
__all__ = [
    'BoundaryError', 'Cancelled', 'Cells', 'Correspondence', 'DataError', 'Deformer', 'Error', 'Field',
    'FileError', 'Folds', 'Grids', 'Map', 'Mesh', 'MeshReport', 'SettingError',
    'check', 'compare_fem', 'correspond', 'deform', 'fit', 'grids', 'harmonic', 'hexahedralize',
    'jobs', 'lattice', 'load', 'load_correspondence', 'polycube', 'pull', 'push', 'read_cells', 'read_mesh',
    'read_vdb', 'read_volume_texture', 'remesh', 'sequence', 'solid_texture', 'sphere', 'study',
    'tetrahedralize', 'transfer_distance', 'voxelize', 'weights', 'write_mesh', 'write_section',
    'write_slices', 'write_volume_texture',
]

class Error(builtins.RuntimeError): ...
class FileError(Error, builtins.OSError): ...
class DataError(Error, builtins.ValueError): ...
class SettingError(Error, builtins.ValueError): ...
class MemoryError(Error, builtins.MemoryError): ...
class Cancelled(Error): ...

class Mesh:
    @property
    def name(self) -> str: ...
    @property
    def vertices(self) -> Floats: ...
    @property
    def triangles(self) -> Ints: ...
    def __iter__(self) -> Iterator[Array]: ...

def read_mesh(
    path: Path, *, progress: Optional[Progress] = None, max_memory: Union[int, str, None] = None,
    threads: int = 0) -> Mesh: ...

def write_mesh(path: Path, *mesh: AnyMesh) -> None: ...

class MeshReport:
    @property
    def vertices(self) -> int: ...
    @property
    def triangles(self) -> int: ...
    @property
    def components(self) -> int: ...
    @property
    def closed(self) -> bool: ...
    @property
    def open_loops(self) -> int: ...
    @property
    def genus(self) -> int: ...
    @property
    def outward(self) -> bool: ...
    @property
    def self_intersections(self) -> int: ...
    @property
    def crossings(self) -> Floats: ...
    @property
    def area(self) -> float: ...
    @property
    def volume(self) -> float: ...
    @property
    def box(self) -> Floats: ...
    @property
    def findings(self) -> List[Dict[str, Union[str, int]]]: ...

def check(
    *mesh: AnyMesh, self_intersections: bool = True, progress: Optional[Progress] = None,
    max_memory: Union[int, str, None] = None, threads: int = 0) -> MeshReport: ...

class BoundaryError:
    @property
    def rms(self) -> float: ...
    @property
    def p99(self) -> float: ...
    @property
    def max(self) -> float: ...
    @property
    def p99_bound(self) -> float: ...
    @property
    def bound(self) -> float: ...
    @property
    def samples(self) -> int: ...

class Grids:
    def __getitem__(self, name: str) -> Array: ...
    def __iter__(self) -> Iterator[str]: ...
    def __len__(self) -> int: ...
    def __contains__(self, name: object) -> bool: ...
    def keys(self) -> List[str]: ...
    def metadata(self, name: str) -> Dict[str, Union[str, float, int, bool]]: ...
    @property
    def matrix(self) -> Floats: ...
    @property
    def bounds(self) -> Floats: ...
    @property
    def voxel_size(self) -> float: ...
    @property
    def shape(self) -> Tuple[int, int, int]: ...
    @property
    def totals(self) -> Dict[str, Union[float, int, str]]: ...
    def write_vdb(
        self, path: Path, *, names: Literal['innermap', 'blender', 'houdini'] = 'innermap',
        progress: Optional[Progress] = None, max_memory: Union[int, str, None] = None,
        threads: int = 0) -> None: ...

class Map:
    @overload
    def __call__(
        self, X: ArrayLike, *, jacobian: Literal[False] = False, accuracy: float = 1e-12,
        progress: Optional[Progress] = None, max_memory: Union[int, str, None] = None,
        threads: int = 0) -> Floats: ...
    @overload
    def __call__(
        self, X: ArrayLike, *, jacobian: Literal[True], accuracy: float = 1e-12,
        progress: Optional[Progress] = None, max_memory: Union[int, str, None] = None,
        threads: int = 0) -> Tuple[Floats, Floats]: ...
    @overload
    def inverse(
        self, Y: ArrayLike, *, jacobian: Literal[False] = False,
        progress: Optional[Progress] = None, max_memory: Union[int, str, None] = None,
        threads: int = 0) -> Tuple[Floats, Bools]: ...
    @overload
    def inverse(
        self, Y: ArrayLike, *, jacobian: Literal[True],
        progress: Optional[Progress] = None, max_memory: Union[int, str, None] = None,
        threads: int = 0) -> Tuple[Floats, Bools, Floats]: ...
    def contains(
        self, X: ArrayLike, *, progress: Optional[Progress] = None,
        max_memory: Union[int, str, None] = None, threads: int = 0) -> Bools: ...
    def save(self, path: Path) -> None: ...
    def prove(
        self, *, cells_per_charge: float = 100, least_cells: int = 50000, error_margin: float = 0.02,
        full: bool = False, progress: Optional[Progress] = None,
        max_memory: Union[int, str, None] = None, threads: int = 0) -> Dict[str, Any]: ...
    def proof_cells(
        self, *, cells_per_charge: float = 100, least_cells: int = 50000,
        progress: Optional[Progress] = None, max_memory: Union[int, str, None] = None,
        threads: int = 0) -> Tuple[Floats, Floats, Floats]: ...
    def verify(
        self, *, proof_cells: float = 100, sample: int = 64, seed: int = 1,
        progress: Optional[Progress] = None, max_memory: Union[int, str, None] = None,
        threads: int = 0) -> Dict[str, Any]: ...
    @property
    def boundary_error(self) -> BoundaryError: ...
    @property
    def tolerance_met(self) -> Optional[bool]: ...
    @property
    def statement(self) -> str: ...
    @property
    def one_to_one(self) -> Dict[str, Union[int, float]]: ...
    @property
    def facts(self) -> Dict[str, str]: ...
    @property
    def notes(self) -> List[str]: ...
    @property
    def warnings(self) -> List[str]: ...
    @property
    def steps(self) -> int: ...
    @property
    def charges(self) -> int: ...
    @property
    def source(self) -> Mesh: ...
    @property
    def target(self) -> Mesh: ...
    @property
    def volumes(self) -> Tuple[float, float]: ...
    def evaluate(
        self, *, resolution: Optional[int] = None, voxel_size: Optional[float] = None,
        lame_lambda: float = 0.0335, lame_mu: float = 0.0224,
        repair: Literal['auto', 'on', 'off'] = 'auto', progress: Optional[Progress] = None,
        max_memory: Union[int, str, None] = None, threads: int = 0) -> Grids: ...
    def write_vdb(
        self, path: Path, *, names: Literal['innermap', 'blender', 'houdini'] = 'innermap',
        resolution: Optional[int] = None, voxel_size: Optional[float] = None,
        lame_lambda: float = 0.0335, lame_mu: float = 0.0224,
        repair: Literal['auto', 'on', 'off'] = 'auto', progress: Optional[Progress] = None,
        max_memory: Union[int, str, None] = None, threads: int = 0) -> None: ...
    def folds(
        self, *, resolution: Optional[int] = None, voxel_size: Optional[float] = None,
        progress: Optional[Progress] = None, max_memory: Union[int, str, None] = None,
        threads: int = 0) -> Folds: ...

class Folds:
    @property
    def share(self) -> float: ...
    @property
    def least_jacobian(self) -> float: ...
    @property
    def folded(self) -> int: ...
    @property
    def checked(self) -> int: ...
    @property
    def places(self) -> Floats: ...

class Correspondence:
    @property
    def source(self) -> Mesh: ...
    @property
    def target(self) -> Mesh: ...
    @property
    def positions(self) -> Floats: ...
    @property
    def triangles(self) -> Ints: ...
    @property
    def barycentric(self) -> Floats: ...
    @property
    def changed(self) -> bool: ...
    @property
    def quality(self) -> Dict[str, Any]: ...
    @property
    def notes(self) -> List[str]: ...
    @property
    def warnings(self) -> List[str]: ...
    def save(self, path: Path) -> None: ...

def correspond(
    *meshes: Any, landmarks: Union[Sequence[Tuple[Place, Place]], Path, None] = None,
    aligned: bool = False, candidates: int = 3, choose: int = 1, mirror: bool = False,
    refine: bool = True, subdivide: float = 0, surface_resolution: Optional[int] = None,
    genus: Optional[int] = None, close: bool = False, seed: int = 1, progress: Optional[Progress] = None,
    max_memory: Union[int, str, None] = None, threads: int = 0,
    max_time: Optional[float] = None) -> Correspondence: ...

def load_correspondence(
    path: Path, *source: AnyMesh, progress: Optional[Progress] = None,
    max_memory: Union[int, str, None] = None, threads: int = 0) -> Correspondence: ...

def sphere(
    *mesh: AnyMesh, surface_resolution: Optional[int] = None, genus: Optional[int] = None,
    close: bool = False, progress: Optional[Progress] = None, max_memory: Union[int, str, None] = None,
    threads: int = 0) -> Tuple[Mesh, Dict[str, Any]]: ...

def fit(
    *meshes: Any, tolerance: Optional[float] = None, charges: Optional[int] = None,
    collocation: Optional[int] = None, max_charges: int = 100000,
    interpolation: Literal['auto', 'linear', 'smooth'] = 'auto',
    one_to_one: Literal['auto', 'on', 'off'] = 'auto', max_steps: int = 64,
    prove: Literal['off', 'core', 'full'] = 'core', proof_cells: float = 8, seed: int = 1,
    distance: Optional[float] = None, radius_ratio: Optional[float] = None,
    solver: Literal['auto', 'dense', 'iterative'] = 'auto',
    method: Literal['tikhonov', 'tsvd'] = 'tikhonov', regularization: Optional[float] = None,
    landmarks: Union[Sequence[Tuple[Place, Place]], Path, None] = None, aligned: bool = False,
    candidates: int = 3, choose: int = 1, mirror: bool = False, refine: bool = True,
    subdivide: float = 0.005, surface_resolution: Optional[int] = None, genus: Optional[int] = None,
    close: bool = False, progress: Optional[Progress] = None, max_memory: Union[int, str, None] = None,
    threads: int = 0, max_time: Optional[float] = None) -> Map: ...

class Field:
    def __call__(
        self, X: ArrayLike, *, accuracy: float = 1e-12, progress: Optional[Progress] = None,
        max_memory: Union[int, str, None] = None, threads: int = 0) -> Floats: ...
    def gradient(
        self, X: ArrayLike, *, accuracy: float = 1e-12, progress: Optional[Progress] = None,
        max_memory: Union[int, str, None] = None, threads: int = 0) -> Floats: ...
    def evaluate(
        self, *, resolution: Optional[int] = None, voxel_size: Optional[float] = None,
        values: bool = True, gradients: bool = True, directions: bool = True, magnitudes: bool = True,
        progress: Optional[Progress] = None, max_memory: Union[int, str, None] = None,
        threads: int = 0) -> Grids: ...
    def write_vdb(
        self, path: Path, *, names: Literal['innermap', 'blender', 'houdini'] = 'innermap',
        resolution: Optional[int] = None, voxel_size: Optional[float] = None, values: bool = True,
        gradients: bool = True, directions: bool = True, magnitudes: bool = True,
        progress: Optional[Progress] = None, max_memory: Union[int, str, None] = None,
        threads: int = 0) -> None: ...
    def save(self, path: Path) -> None: ...
    def contains(
        self, X: ArrayLike, *, progress: Optional[Progress] = None,
        max_memory: Union[int, str, None] = None, threads: int = 0) -> Bools: ...
    @property
    def channels(self) -> List[str]: ...
    @property
    def boundary_error(self) -> BoundaryError: ...
    @property
    def bound(self) -> float: ...
    @property
    def span(self) -> float: ...
    @property
    def tolerance_met(self) -> Optional[bool]: ...
    @property
    def facts(self) -> Dict[str, str]: ...
    @property
    def notes(self) -> List[str]: ...
    @property
    def warnings(self) -> List[str]: ...
    @property
    def charges(self) -> int: ...
    @property
    def source(self) -> Mesh: ...

def harmonic(
    *mesh_and_values: Any, values: Union[ArrayLike, Callable[[Floats], ArrayLike], None] = None,
    fix: Union[GroupValues, Triangles, None] = None,
    flux: Union[GroupValues, ArrayLike, Callable[[Floats, Floats], ArrayLike], None] = None,
    groups: Optional[Mapping[str, ArrayLike]] = None, names: Optional[Sequence[str]] = None,
    tolerance: float = 0.001, max_charges: int = 100000, seed: int = 1, crease_angle: float = 30,
    progress: Optional[Progress] = None, max_memory: Union[int, str, None] = None,
    threads: int = 0) -> Field: ...

def weights(
    *mesh_and_groups: Any, groups: Union[Mapping[str, ArrayLike], Sequence[str], None] = None,
    tolerance: float = 0.01, max_charges: int = 100000, seed: int = 1, crease_angle: float = 30,
    progress: Optional[Progress] = None, max_memory: Union[int, str, None] = None,
    threads: int = 0) -> Field: ...

def load(
    path: Path, *, progress: Optional[Progress] = None, max_memory: Union[int, str, None] = None,
    threads: int = 0) -> Union[Map, Field]: ...

AnyCells = Any  # Cells, a path, (points, cells), or an object with points and cells

class Cells:
    @property
    def points(self) -> Floats: ...
    @property
    def cells(self) -> List[Tuple[str, Any]]: ...
    @property
    def cells_dict(self) -> Dict[str, Any]: ...
    @property
    def point_data(self) -> Dict[str, Any]: ...
    @property
    def cell_data(self) -> Dict[str, List[Any]]: ...
    @property
    def figures(self) -> Dict[str, Any]: ...
    def to_meshio(self) -> Any: ...
    def surface(self) -> Mesh: ...
    def quality(
        self, *, progress: Optional[Progress] = None, max_memory: Union[int, str, None] = None,
        threads: int = 0) -> Dict[str, Any]: ...
    def prove(
        self, *, progress: Optional[Progress] = None, max_memory: Union[int, str, None] = None,
        threads: int = 0) -> Dict[str, Any]: ...
    def write(self, path: Path) -> List[str]: ...

def read_cells(
    path: Path, *, progress: Optional[Progress] = None, max_memory: Union[int, str, None] = None,
    threads: int = 0) -> Cells: ...

def tetrahedralize(
    *mesh: AnyMesh, resolution: int = 64, edge: Optional[float] = None, features: Optional[float] = None,
    keep_topology: bool = True, progress: Optional[Progress] = None,
    max_memory: Union[int, str, None] = None, threads: int = 0) -> Cells: ...

def hexahedralize(
    *mesh: AnyMesh, pieces: int = 2, feature_angle: float = 30, seed: int = 1,
    blocks: Optional[int] = None, surface_resolution: Optional[int] = None, genus: Optional[int] = None,
    close: bool = False, progress: Optional[Progress] = None, max_memory: Union[int, str, None] = None,
    threads: int = 0, max_time: Optional[float] = None) -> Cells: ...

def polycube(
    *mesh: AnyMesh, pieces: Optional[int] = None, blocks: Optional[int] = None,
    surface_resolution: Optional[int] = None, genus: Optional[int] = None, close: bool = False,
    progress: Optional[Progress] = None, max_memory: Union[int, str, None] = None,
    threads: int = 0) -> Tuple[Mesh, Dict[str, Any]]: ...

def remesh(
    map: Map, cells: AnyCells, *, surface: Optional[AnyMesh] = None, back: bool = False,
    keep_connectivity: bool = False, angle: float = 10, coarse: int = 32,
    vectors: Union[str, Sequence[str], None] = None, normals: Union[str, Sequence[str], None] = None,
    progress: Optional[Progress] = None, max_memory: Union[int, str, None] = None, threads: int = 0,
    max_time: Optional[float] = None) -> Cells: ...

def compare_fem(
    *meshes: Any, resolutions: Optional[Sequence[int]] = None, charges: Optional[Sequence[int]] = None,
    tolerances: Optional[Sequence[float]] = None, reference: float = 0.0002, samples: int = 20000,
    seed: int = 1, progress: Optional[Progress] = None, max_memory: Union[int, str, None] = None,
    threads: int = 0) -> Dict[str, Any]: ...

def push(
    map: Map, inside: Any, path: Optional[Path]=None, *, jacobian: bool = False,
    through: Optional[AnyCells] = None, subdivide: float = 0,
    grids: Union[str, Sequence[str], None] = None,
    densities: Union[bool, str, Sequence[str], None] = None,
    stresses: Union[str, Sequence[str], None] = None, strains: Union[str, Sequence[str], None] = None,
    sampling: Literal['nearest', 'linear', 'quadratic'] = 'linear',
    density_limit: Optional[float] = None, outside: float = 0,
    fade_to: Union[str, ArrayLike, None] = None, vectors: Union[str, Sequence[str], None] = None,
    normals: Union[str, Sequence[str], None] = None, splats: Literal['look', 'mass'] = 'look',
    resolution: Optional[int] = None, voxel_size: Optional[float] = None,
    names: Literal['innermap', 'blender', 'houdini'] = 'innermap', progress: Optional[Progress] = None,
    max_memory: Union[int, str, None] = None, threads: int = 0) -> Any: ...

def pull(
    map: Map, inside: Any, path: Optional[Path]=None, *, jacobian: bool = False,
    through: Optional[AnyCells] = None, subdivide: float = 0,
    grids: Union[str, Sequence[str], None] = None,
    densities: Union[bool, str, Sequence[str], None] = None,
    stresses: Union[str, Sequence[str], None] = None, strains: Union[str, Sequence[str], None] = None,
    sampling: Literal['nearest', 'linear', 'quadratic'] = 'linear',
    density_limit: Optional[float] = None, outside: float = 0,
    fade_to: Union[str, ArrayLike, None] = None, vectors: Union[str, Sequence[str], None] = None,
    normals: Union[str, Sequence[str], None] = None, splats: Literal['look', 'mass'] = 'look',
    resolution: Optional[int] = None, voxel_size: Optional[float] = None,
    names: Literal['innermap', 'blender', 'houdini'] = 'innermap', progress: Optional[Progress] = None,
    max_memory: Union[int, str, None] = None, threads: int = 0) -> Any: ...

class Deformer:
    def __init__(
        self, source: AnyMesh, X: ArrayLike, *, charges: int = 8000, collocation: Optional[int] = None,
        distance: Optional[float] = None, seed: int = 1, outside: float = 0,
        fade_to: Union[str, ArrayLike, None] = None, progress: Optional[Progress] = None,
        max_memory: Union[int, str, None] = None, threads: int = 0) -> None: ...
    def __call__(
        self, frame: Any, *, progress: Optional[Progress] = None,
        max_memory: Union[int, str, None] = None, threads: int = 0) -> Floats: ...
    def measure(
        self, frame: Any, *, progress: Optional[Progress] = None,
        max_memory: Union[int, str, None] = None, threads: int = 0) -> Dict[str, float]: ...
    @property
    def found(self) -> Bools: ...

def lattice(
    bounds: ArrayLike, *, resolution: int = 32) -> Tuple[Floats, Tuple[int, int, int], float]: ...

def deform(
    source: AnyMesh, inside: Any, frames: Any, output: Optional[Path]=None, *, velocity: bool = False,
    shutter: float = 0.5, only: Optional[str] = None, numbers: Optional[Sequence[int]] = None,
    first_frame: Optional[int] = None, fps: float = 24, rest: Optional[int] = None,
    up: Optional[Literal['y', 'z']] = None, unit_scale: Optional[float] = None, mesh: str = '',
    animation: str = '', charges: int = 8000, collocation: Optional[int] = None,
    distance: Optional[float] = None, seed: int = 1, grids: Union[str, Sequence[str], None] = None,
    densities: Union[bool, str, Sequence[str], None] = None,
    stresses: Union[str, Sequence[str], None] = None, strains: Union[str, Sequence[str], None] = None,
    sampling: Literal['nearest', 'linear', 'quadratic'] = 'linear',
    density_limit: Optional[float] = None, outside: float = 0,
    fade_to: Union[str, ArrayLike, None] = None, vectors: Union[str, Sequence[str], None] = None,
    normals: Union[str, Sequence[str], None] = None, splats: Literal['look', 'mass'] = 'look',
    resolution: Optional[int] = None, voxel_size: Optional[float] = None,
    names: Literal['innermap', 'blender', 'houdini'] = 'innermap', progress: Optional[Progress] = None,
    max_memory: Union[int, str, None] = None, threads: int = 0) -> Any: ...

def sequence(
    source: AnyMesh, frames: Any, *, output: Optional[Path] = None,
    grids: Union[str, Sequence[str], None] = None, only: Optional[str] = None,
    numbers: Optional[Sequence[int]] = None, first_frame: Optional[int] = None, fps: float = 24,
    rest: Optional[int] = None, up: Optional[Literal['y', 'z']] = None,
    unit_scale: Optional[float] = None, mesh: str = '', animation: str = '', charges: int = 8000,
    collocation: Optional[int] = None, distance: Optional[float] = None, seed: int = 1,
    prove: Literal['off', 'core', 'full'] = 'off', proof_cells: float = 8,
    resolution: Optional[int] = None, voxel_size: Optional[float] = None, lame_lambda: float = 0.0335,
    lame_mu: float = 0.0224, names: Literal['innermap', 'blender', 'houdini'] = 'innermap',
    progress: Optional[Progress] = None, max_memory: Union[int, str, None] = None,
    threads: int = 0) -> Dict[str, Any]: ...

def grids(
    arrays: Mapping[str, ArrayLike], matrix: ArrayLike, *, background: Optional[float] = None,
    tolerance: float = 0, level_sets: Union[str, Sequence[str], None] = None,
    fogs: Union[str, Sequence[str], None] = None, progress: Optional[Progress] = None,
    max_memory: Union[int, str, None] = None, threads: int = 0) -> Grids: ...

def read_vdb(
    path: Path, *, names: Union[str, Sequence[str], None] = None, progress: Optional[Progress] = None,
    max_memory: Union[int, str, None] = None, threads: int = 0) -> Grids: ...

def voxelize(
    *mesh: AnyMesh, resolution: Optional[int] = None, voxel_size: Optional[float] = None,
    half_width: float = 3, fog: bool = False, attributes: bool = False,
    progress: Optional[Progress] = None, max_memory: Union[int, str, None] = None,
    threads: int = 0) -> Grids: ...

def transfer_distance(
    map: Map, *, resolution: Optional[int] = None, voxel_size: Optional[float] = None,
    progress: Optional[Progress] = None, max_memory: Union[int, str, None] = None,
    threads: int = 0) -> Tuple[Grids, Grids]: ...

def write_slices(
    path: Path, grids: Union[Grids, Path], *, axis: Literal['x', 'y', 'z'] = 'z', slices: int = 16,
    half: bool = False, names: Union[str, Sequence[str], None] = None,
    progress: Optional[Progress] = None, max_memory: Union[int, str, None] = None,
    threads: int = 0) -> Dict[str, Any]: ...

def write_section(
    path: Path, grids: Union[Grids, Path], *, grid: Optional[str] = None,
    component: Literal['x', 'y', 'z', 'length'] = 'length', colour: bool = False,
    axis: Literal['x', 'y', 'z'] = 'z', at: float = 0.5, position: Optional[float] = None,
    colormap: Literal['red-blue', 'viridis', 'cividis', 'inferno', 'grey'] = 'red-blue',
    scale: Literal['auto', 'linear', 'log', 'about-1'] = 'auto', pixels: int = 900,
    range: Optional[Tuple[float, float]] = None, progress: Optional[Progress] = None,
    max_memory: Union[int, str, None] = None, threads: int = 0) -> Dict[str, Any]: ...

def write_volume_texture(
    path: Path, grids: Union[Grids, Path], *, layout: Literal['atlas', 'slices', 'parts'] = 'atlas',
    half: bool = False, channels: Literal['auto', 'rgba', 'layers'] = 'auto',
    resolution: Optional[int] = None, pad: int = 0, cube: bool = False, power_of_two: bool = False,
    axis: Literal['x', 'y', 'z'] = 'z', active: bool = False, zip: bool = False,
    names: Union[str, Sequence[str], None] = None, rows_up: bool = False,
    tiles: Optional[Tuple[int, int]] = None, progress: Optional[Progress] = None,
    max_memory: Union[int, str, None] = None, threads: int = 0) -> Dict[str, Any]: ...

def read_volume_texture(
    path: Path, *, names: Union[str, Sequence[str], None] = None,
    layout: Optional[Literal['atlas', 'slices', 'parts']] = None, slices: Optional[int] = None,
    voxel_size: Optional[float] = None, axis: Optional[Literal['x', 'y', 'z']] = None,
    background: Optional[float] = None, as_voxels: bool = False, tiles: Optional[Tuple[int, int]] = None,
    rows_up: Optional[bool] = None, lower_corner: Optional[ArrayLike] = None,
    progress: Optional[Progress] = None, max_memory: Union[int, str, None] = None,
    threads: int = 0) -> Grids: ...

def solid_texture(
    mesh: AnyMesh, image: Optional[Path]=None, *, colours: Optional[ArrayLike] = None,
    mode: Literal['uv', 'colour'] = 'uv', seams: Literal['keep', 'blend'] = 'keep',
    charges: Optional[int] = None, seed: int = 1,
    colour_space: Literal['auto', 'linear', 'srgb'] = 'auto',
    wrap: Literal['repeat', 'clamp', 'mirror', 'black'] = 'repeat', resolution: Optional[int] = None,
    voxel_size: Optional[float] = None, progress: Optional[Progress] = None,
    max_memory: Union[int, str, None] = None, threads: int = 0) -> Grids: ...

def study(
    *meshes: Any, charges: Optional[Sequence[int]] = None, points: Optional[Sequence[float]] = None,
    distances: Optional[Sequence[float]] = None, radius_ratios: Optional[Sequence[float]] = None,
    base_charges: int = 1000, base_points: float = 4, base_distance: Optional[float] = None,
    base_radius_ratio: float = 1.5, grid: Literal['none', 'pairs', 'full'] = 'pairs',
    interpolation: Literal['linear', 'smooth'] = 'linear',
    method: Literal['tikhonov', 'tsvd'] = 'tikhonov', regularization: Optional[float] = None,
    resolution: int = 64, seed: int = 1, lame_lambda: float = 0.0335, lame_mu: float = 0.0224,
    folder: Optional[Path] = None, progress: Optional[Progress] = None,
    max_memory: Union[int, str, None] = None, threads: int = 0,
    max_time: Optional[float] = None) -> Tuple[Dict[str, Any], Dict[str, Any]]: ...

def jobs(
    path: Path, command: Sequence[str], *, tasks: int = 1, first: Optional[Sequence[str]] = None,
    join: Optional[Sequence[str]] = None, seconds: float = 0, memory: int = 0, first_seconds: float = 0,
    first_memory: int = 0, join_seconds: float = 0, join_memory: int = 0, cores: int = 1,
    folder: str = '', name: str = 'innermap') -> None: ...
