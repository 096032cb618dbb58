"""What the type stubs say is what the module has: names, bases, parameters and their defaults."""

import ast
import builtins
import inspect
import subprocess
from pathlib import Path

import cli
import innermap

STUB = Path(innermap.__file__).with_name("_innermap.pyi")
SPECIAL = ("__call__", "__getitem__", "__iter__", "__len__", "__contains__")


def members(cls):
    return {name: value for name, value in vars(cls).items()
            if name in SPECIAL or not name.startswith("_") or
            name == "__init__" and inspect.isroutine(value) and "Keyword arguments" in value.__doc__}


def parameters_of(definition):
    """(name, kind, default) of a function of the stub."""
    args = definition.args
    none = [None] * (len(args.args) - len(args.defaults))
    yield from ((a.arg, "plain", d) for a, d in zip(args.args, none + args.defaults))
    if args.vararg:
        yield args.vararg.arg, "any", None
    yield from ((a.arg, "keyword", d) for a, d in zip(args.kwonlyargs, args.kw_defaults))


KINDS = {inspect.Parameter.POSITIONAL_OR_KEYWORD: "plain", inspect.Parameter.KEYWORD_ONLY: "keyword",
         inspect.Parameter.VAR_POSITIONAL: "any"}


def differences(name, definitions, function):
    """Of overloads together: a parameter whose default only some have is one of the function's."""
    try:
        signature = inspect.signature(function)
    except ValueError:  # of pybind11's own def(), without keywords
        return
    actual = [(p.name, KINDS[p.kind]) for p in signature.parameters.values()]
    for definition in definitions:
        said = list(parameters_of(definition))
        if [(n, k) for n, k, _ in said] != actual:
            yield f"{name}: {[n for n, _, _ in said]}, the module has {[n for n, _ in actual]}"
            return
        for parameter, _, default in said:
            has = signature.parameters[parameter].default
            if default is None:
                if has is not inspect.Parameter.empty and len(definitions) == 1:
                    yield f"{name}: {parameter} has the default {has!r}"
            elif ast.literal_eval(default) != has:
                yield f"{name}: {parameter} has the default {has!r}"


def functions(body):
    out = {}
    for node in body:
        if isinstance(node, ast.FunctionDef):
            out.setdefault(node.name, []).append(node)
    return out


def compare(tree):
    classes = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
    free = functions(tree.body)
    names = [*innermap.__all__, "MemoryError"]
    for name in (set(classes) | set(free)) - set(names):
        yield f"{name}: not in the module"
    for name in names:
        thing = getattr(innermap, name)
        if not inspect.isclass(thing):
            yield from (differences(name, free[name], thing) if name in free
                        else [f"{name}: not in the stub"])
        elif name not in classes:
            yield f"{name}: not in the stub"
        elif issubclass(thing, Exception):
            said = [ast.unparse(base).rpartition(".")[2] for base in classes[name].bases]
            if said != [base.__name__ for base in thing.__bases__]:
                yield f"{name}: its bases are {thing.__bases__}"
        else:
            yield from compare_class(name, functions(classes[name].body), members(thing))


def compare_class(name, said, has):
    for member in set(said) ^ set(has):
        yield f"{name}.{member}: only in {'the stub' if member in said else 'the module'}"
    for member in set(said) & set(has):
        value = has[member]
        is_property = any(ast.unparse(d) == "property" for d in said[member][0].decorator_list)
        if is_property != isinstance(value, property):
            yield f"{name}.{member}: a property or not"
        elif not is_property:
            yield from differences(f"{name}.{member}", said[member], value)


def test_are_complete():
    tree = ast.parse(STUB.read_text(encoding="utf-8"))
    found = list(compare(tree))
    assert not found, "\n".join(found)
    exported = next(ast.literal_eval(node.value) for node in tree.body
                    if isinstance(node, ast.Assign) and node.targets[0].id == "__all__")
    assert sorted(exported) == sorted(innermap.__all__)
    assert STUB.with_name("py.typed").exists()


def test_keywords_are_as_the_module_describes_them():
    script = cli.ROOT / "scripts" / "update-stubs"
    done = subprocess.run([script, "--check", Path(innermap.__file__).parents[1]], capture_output=True,
                          text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_everything_is_documented():
    for name in innermap.__all__:
        thing = getattr(innermap, name)
        assert thing.__doc__, name
        assert thing.__module__ == "innermap", name
        if inspect.isclass(thing) and not issubclass(thing, Exception):
            for member, value in members(thing).items():
                assert value.__doc__ or member in SPECIAL, f"{name}.{member}"
    assert not set(innermap.__all__) & set(dir(builtins))


if __name__ == "__main__":
    cli.run(globals())
