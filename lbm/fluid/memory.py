"""Reading and writing the 19 populations of a cell so that the compiler vectorises along a row.

Two things stop it otherwise: Numba's signed indices, which may wrap around, and the fear that a store to one
population changes the next load of another.  These intrinsics compute plain addresses and give each of the
19 rows its own alias scope; a row is read and written at the same addresses, so in-place update stays legal.
"""

from __future__ import annotations

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from lbm.fluid.stencil import Q

LINE_BYTES = 64
"""Of a cache line."""


def _alias_scopes(module):
    """One (scope, all other scopes) pair of metadata lists a population, and one for the rates, the last."""
    domain = module.add_metadata([ir.MetaDataString(module, "lbm populations")])
    names = [*(f"population {k}" for k in range(Q)), "rates"]
    scopes = [module.add_metadata([ir.MetaDataString(module, name), domain]) for name in names]
    return [(module.add_metadata([s]), module.add_metadata([t for t in scopes if t is not s])) for s in scopes]


def rates_scopes(module):
    """The pair of metadata lists of what no store to a population changes."""
    return _alias_scopes(module)[Q]


def _addresses(context, builder, array_type, array, starts, x):
    data = context.make_array(array_type)(context, builder, array).data
    return [
        builder.gep(data, [builder.add(start, x)], inbounds=True)
        for start in cgutils.unpack_tuple(builder, starts, Q)
    ]


@intrinsic
def load_cell(typingctx, array, starts, x):
    """The 19 values ``array[starts[k] + x]``; ``starts`` are 19 int64, ``array`` is flat."""
    result = types.UniTuple(array.dtype, Q)

    def codegen(context, builder, signature, args):
        values = []
        addresses = _addresses(context, builder, signature.args[0], *args)
        for address, (scope, others) in zip(addresses, _alias_scopes(builder.module)[:Q], strict=True):
            value = builder.load(address)
            value.set_metadata("alias.scope", scope)
            value.set_metadata("noalias", others)
            values.append(value)
        return context.make_tuple(builder, result, values)

    return result(array, starts, x), codegen


@intrinsic
def store_cell(typingctx, array, starts, x, values):
    """Set ``array[starts[k] + x] = values[k]``."""

    def codegen(context, builder, signature, args):
        array, starts, x, values = args
        addresses = _addresses(context, builder, signature.args[0], array, starts, x)
        new = cgutils.unpack_tuple(builder, values, Q)
        for address, value, (scope, others) in zip(addresses, new, _alias_scopes(builder.module)[:Q], strict=True):
            instruction = builder.store(value, address)
            instruction.set_metadata("alias.scope", scope)
            instruction.set_metadata("noalias", others)
        return context.get_dummy_value()

    return types.void(array, starts, x, values), codegen


def _prefetch(builder, address):
    i32 = ir.IntType(32)
    pointer = ir.IntType(8).as_pointer()
    signature = ir.FunctionType(ir.VoidType(), [pointer, i32, i32, i32])
    request = cgutils.get_or_insert_function(builder.module, signature, "llvm.prefetch.p0")
    for_writing, keep_close, data = i32(1), i32(3), i32(1)
    builder.call(request, [builder.bitcast(address, pointer), for_writing, keep_close, data])


@intrinsic
def prefetch_cell(typingctx, array, starts, x):
    """Ask for the 19 cache lines of ``array[starts[k] + x]``, to be read and then written."""

    def codegen(context, builder, signature, args):
        for address in _addresses(context, builder, signature.args[0], *args):
            _prefetch(builder, address)
        return context.get_dummy_value()

    return types.void(array, starts, x), codegen


@intrinsic
def prefetch(typingctx, array, index):
    """Ask for the cache line of ``array[index]``, to be read and then written."""

    def codegen(context, builder, signature, args):
        data = context.make_array(signature.args[0])(context, builder, args[0]).data
        _prefetch(builder, builder.gep(data, [args[1]]))
        return context.get_dummy_value()

    return types.void(array, index), codegen


@intrinsic
def line_length(typingctx, array):
    """Elements of ``array`` in a cache line of 64 bytes, as a constant of the compiled code."""

    def codegen(context, builder, signature, args):
        size = context.get_abi_sizeof(context.get_data_type(signature.args[0].dtype))
        return context.get_constant(types.int64, LINE_BYTES // size)

    return types.int64(array), codegen
