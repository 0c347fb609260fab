/* Makes NumPy generalized ufuncs of compiled batch kernels.
 *
 * A batch kernel is any function of the type `batch_function` below. `make` wraps one into a gufunc with double inputs,
 * double outputs and the int status as last output. NumPy broadcasts, casts and allocates; the loop below hands its
 * pointers and steps straight to the kernel, and packs only those arguments whose core arrays are not laid out as the
 * kernel wants them.
 *
 * One gufunc owns one `kernel` (reached through the loop's data pointer): the function, a private copy of the
 * geometry, and the texts and tables that NumPy keeps pointers to. It lives in a capsule, which lives in ufunc->obj
 * together with the Python object that keeps the kernel's library loaded. Nothing here is mutable after `make`, so the
 * loop runs on any number of threads at once, without the interpreter's lock.
 */
#define PY_SSIZE_T_CLEAN
#include <Python.h>

#define NPY_NO_DEPRECATED_API NPY_1_7_API_VERSION
#include <numpy/arrayobject.h>
#include <numpy/ufuncobject.h>

#include <fenv.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* Steps are counted in elements, not bytes, from one member of the batch to the next. Each member's core array is
 * contiguous, in row-major order. The returned value, the first status that is not OK, is not needed here. */
typedef int (*batch_function)(const void *geometry, size_t count, const double *const in[], const ptrdiff_t in_step[],
                              double *const out[], const ptrdiff_t out_step[], int *status, ptrdiff_t status_step);

enum {
    MAX_ARGUMENTS = 32, /* of a ufunc in NumPy 1; NumPy 2 allows more */
    MAX_CORE_DIMS = 4,
    MAX_CORE_SIZE = 1024, /* doubles in one argument's core array */
    MAX_TOTAL = 4096,     /* doubles in all core arrays together: the loop's buffer, 32 KiB of stack */
    MAX_BLOCK = 64,       /* members of a batch that are packed at a time */
    GEOMETRY_ALIGNMENT = 64
};

#define NUMPY_FLAGS (FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW | FE_UNDERFLOW)

static const char CAPSULE_NAME[] = "krhpr.native.kernel";

typedef struct {
    int dims;
    npy_intp shape[MAX_CORE_DIMS];
    npy_intp size;   /* product of the shape */
    int first_step;  /* where the steps of its core dimensions start in the loop's steps */
} argument;

typedef struct {
    batch_function function;
    const void *geometry;
    int nin, nout; /* of doubles; the status is argument nin + nout */
    argument arguments[MAX_ARGUMENTS];
    PyUFuncGenericFunction loops[1];
    void *data[1];
    char types[MAX_ARGUMENTS];
    char *name, *doc; /* behind the geometry, in the same allocation */
} kernel;

/* ------------------------------------------------------------------------------------------------------ the loop -- */

/* Whether a kernel can work on the argument where it lies. */
static int lies_ready(const argument *a, const char *start, npy_intp count, npy_intp step, const npy_intp *core_steps)
{
    npy_intp expected = (npy_intp)sizeof(double);
    if ((uintptr_t)start % _Alignof(double) != 0 || (count > 1 && step % expected != 0)) {
        return 0;
    }
    for (int d = a->dims - 1; d >= 0; --d) {
        if (a->shape[d] != 1 && core_steps[d] != expected) {
            return 0;
        }
        expected *= a->shape[d];
    }
    return 1;
}

/* Moves one core array between a strided place and a packed one. `packed` advances row by row; memcpy because a strided
 * place may be unaligned. */
static void move_core(const argument *a, char *strided, const npy_intp *core_steps, double *packed, int gather)
{
    npy_intp index[MAX_CORE_DIMS] = {0};
    const int last = a->dims - 1;
    const npy_intp row = last < 0 ? 1 : a->shape[last];
    const npy_intp row_step = last < 0 ? 0 : core_steps[last];
    for (;;) {
        char *place = strided;
        for (int d = 0; d < last; ++d) {
            place += index[d] * core_steps[d];
        }
        if (gather) {
            for (npy_intp i = 0; i < row; ++i, place += row_step) {
                memcpy(packed++, place, sizeof(double));
            }
        }
        else {
            for (npy_intp i = 0; i < row; ++i, place += row_step) {
                memcpy(place, packed++, sizeof(double));
            }
        }
        int d = last - 1;
        while (d >= 0 && ++index[d] == a->shape[d]) {
            index[d--] = 0;
        }
        if (d < 0) {
            return;
        }
    }
}

/* The kernel on the whole batch; `ready` says which arguments can be used where they lie. Those that cannot are packed
 * in blocks, so that kernels that work on several members at a time still get several. */
static void call_in_blocks(const kernel *k, char *const *starts, npy_intp count, const npy_intp *steps,
                           const int *ready)
{
    const int doubles = k->nin + k->nout, nargs = doubles + 1;
    double buffer[MAX_TOTAL];
    double *packed[MAX_ARGUMENTS] = {NULL};
    double *places[MAX_ARGUMENTS];
    ptrdiff_t place_steps[MAX_ARGUMENTS];

    npy_intp total = 0;
    for (int i = 0; i < doubles; ++i) {
        total += ready[i] ? 0 : k->arguments[i].size;
    }
    npy_intp block = total * MAX_BLOCK <= MAX_TOTAL ? MAX_BLOCK : MAX_TOTAL / total;
    double *free_place = buffer;
    for (int i = 0; i < doubles; ++i) {
        if (!ready[i]) {
            packed[i] = free_place;
            free_place += block * k->arguments[i].size;
        }
        place_steps[i] = ready[i] ? steps[i] / (npy_intp)sizeof(double) : k->arguments[i].size;
    }

    for (npy_intp done = 0; done < count; done += block) {
        const npy_intp now = count - done < block ? count - done : block;
        for (int i = 0; i < doubles; ++i) {
            const argument *a = &k->arguments[i];
            char *start = starts[i] + done * steps[i];
            places[i] = ready[i] ? (double *)start : packed[i];
            if (!ready[i] && i < k->nin) {
                for (npy_intp j = 0; j < now; ++j) {
                    move_core(a, start + j * steps[i], steps + nargs + a->first_step, packed[i] + j * a->size, 1);
                }
            }
        }
        k->function(k->geometry, (size_t)now, (const double *const *)places, place_steps, places + k->nin,
                    place_steps + k->nin, (int *)(starts[doubles] + done * steps[doubles]),
                    steps[doubles] / (npy_intp)sizeof(int));
        for (int i = k->nin; i < doubles; ++i) {
            const argument *a = &k->arguments[i];
            char *start = starts[i] + done * steps[i];
            for (npy_intp j = 0; !ready[i] && j < now; ++j) {
                move_core(a, start + j * steps[i], steps + nargs + a->first_step, packed[i] + j * a->size, 0);
            }
        }
    }
}

/* NumPy calls this without the interpreter's lock (for batches worth it): no Python here. Every argument is aligned, as
 * NumPy promises. */
static void loop(char **starts, const npy_intp *dimensions, const npy_intp *steps, void *data)
{
    const kernel *k = data;
    const int doubles = k->nin + k->nout, nargs = doubles + 1;
    const npy_intp count = dimensions[0];
    if (count <= 0) {
        return;
    }

    int ready[MAX_ARGUMENTS], all_ready = 1;
    for (int i = 0; i < doubles; ++i) {
        const argument *a = &k->arguments[i];
        ready[i] = lies_ready(a, starts[i], count, steps[i], steps + nargs + a->first_step);
        all_ready &= ready[i];
    }
    if (all_ready) {
        ptrdiff_t place_steps[MAX_ARGUMENTS];
        double *places[MAX_ARGUMENTS];
        for (int i = 0; i < doubles; ++i) {
            places[i] = (double *)starts[i];
            place_steps[i] = steps[i] / (npy_intp)sizeof(double);
        }
        k->function(k->geometry, (size_t)count, (const double *const *)places, place_steps, places + k->nin,
                    place_steps + k->nin, (int *)starts[doubles], steps[doubles] / (npy_intp)sizeof(int));
    }
    else {
        call_in_blocks(k, starts, count, steps, ready);
    }

    /* The status says what went wrong. NumPy would warn of the flags, which branch-free kernels also raise where all is
     * well: in the halves of a choice that are not taken. */
    if (fetestexcept(NUMPY_FLAGS) != 0) {
        feclearexcept(NUMPY_FLAGS);
    }
}

/* -------------------------------------------------------------------------------------------------- construction -- */

static void free_kernel(PyObject *capsule)
{
    PyMem_RawFree(PyCapsule_GetPointer(capsule, CAPSULE_NAME));
}

/* The kernel with its geometry, name and doc, in one piece of memory. */
static kernel *new_kernel(PyObject *name, PyObject *doc, const Py_buffer *geometry)
{
    Py_ssize_t name_size, doc_size;
    const char *name_text = PyUnicode_AsUTF8AndSize(name, &name_size);
    const char *doc_text = PyUnicode_AsUTF8AndSize(doc, &doc_size);
    if (name_text == NULL || doc_text == NULL) {
        return NULL;
    }
    const size_t geometry_size = geometry == NULL ? 0 : (size_t)geometry->len;
    kernel *k = PyMem_RawCalloc(1, sizeof(kernel) + GEOMETRY_ALIGNMENT + geometry_size + (size_t)name_size + 1 +
                                       (size_t)doc_size + 1);
    if (k == NULL) {
        PyErr_NoMemory();
        return NULL;
    }
    char *place = (char *)(k + 1);
    place += (GEOMETRY_ALIGNMENT - (uintptr_t)place % GEOMETRY_ALIGNMENT) % GEOMETRY_ALIGNMENT;
    if (geometry != NULL) {
        k->geometry = place;
        if (PyBuffer_ToContiguous(place, (Py_buffer *)geometry, geometry->len, 'C') < 0) {
            PyMem_RawFree(k);
            return NULL;
        }
    }
    k->name = place + geometry_size;
    memcpy(k->name, name_text, (size_t)name_size);
    k->doc = k->name + name_size + 1;
    memcpy(k->doc, doc_text, (size_t)doc_size);
    return k;
}

/* Reads the core shapes that NumPy found in the signature, and refuses what the loop is not made for. */
static int read_signature(kernel *k, const PyUFuncObject *ufunc)
{
    npy_intp total = 0;
    for (int i = 0; i < ufunc->nargs; ++i) {
        argument *a = &k->arguments[i];
        a->dims = ufunc->core_num_dims[i];
        a->first_step = ufunc->core_offsets[i];
        a->size = 1;
        if (a->dims > MAX_CORE_DIMS) {
            PyErr_Format(PyExc_ValueError, "%s: argument %d of %s has %d core dimensions; at most %d are supported",
                         k->name, i, ufunc->core_signature, a->dims, MAX_CORE_DIMS);
            return -1;
        }
        for (int d = 0; d < a->dims; ++d) {
            const int ix = ufunc->core_dim_ixs[a->first_step + d];
            const npy_intp size = ufunc->core_dim_sizes[ix];
            if (size <= 0 || (ufunc->core_dim_flags[ix] & (UFUNC_CORE_DIM_SIZE_INFERRED | UFUNC_CORE_DIM_CAN_IGNORE))) {
                PyErr_Format(PyExc_ValueError, "%s: every core dimension of %s must be a positive number", k->name,
                             ufunc->core_signature);
                return -1;
            }
            if (size > MAX_CORE_SIZE || a->size * size > MAX_CORE_SIZE) {
                PyErr_Format(PyExc_ValueError, "%s: argument %d of %s has more than %d core elements", k->name, i,
                             ufunc->core_signature, MAX_CORE_SIZE);
                return -1;
            }
            a->shape[d] = size;
            a->size *= size;
        }
        total += a->size;
    }
    if (total > MAX_TOTAL) {
        PyErr_Format(PyExc_ValueError, "%s: the arguments of %s have more than %d core elements together", k->name,
                     ufunc->core_signature, MAX_TOTAL);
        return -1;
    }
    if (k->arguments[ufunc->nargs - 1].dims != 0) {
        PyErr_Format(PyExc_ValueError, "%s: the last output of %s is the status and must be ()", k->name,
                     ufunc->core_signature);
        return -1;
    }
    return 0;
}

/* The gufunc around k, without its keeper. */
static PyUFuncObject *new_ufunc(kernel *k, const char *signature)
{
    const int doubles = k->nin + k->nout;
    memset(k->types, NPY_DOUBLE, (size_t)doubles);
    k->types[doubles] = NPY_INT;
    k->loops[0] = loop;
    k->data[0] = k;
    PyUFuncObject *ufunc = (PyUFuncObject *)PyUFunc_FromFuncAndDataAndSignature(
        k->loops, k->data, k->types, 1, k->nin, k->nout + 1, PyUFunc_None, k->name, k->doc, 0, signature);
    if (ufunc == NULL) {
        return NULL;
    }
    if (read_signature(k, ufunc) < 0) {
        Py_DECREF(ufunc);
        return NULL;
    }
    /* NumPy takes for granted that a loop may write an output over an input that lies at the same place, as element by
     * element functions may. A kernel may not: ask for copies then (as NumPy's own matmul does). */
    for (int i = k->nin; i < ufunc->nargs; ++i) {
        ufunc->op_flags[i] = NPY_ITER_WRITEONLY | NPY_ITER_UPDATEIFCOPY | NPY_ITER_ALIGNED | NPY_ITER_ALLOCATE |
                             NPY_ITER_NO_BROADCAST | NPY_ITER_NO_SUBTYPE;
    }
    return ufunc;
}

static PyObject *make_from(PyObject *name, PyObject *doc, PyObject *function, const Py_buffer *geometry,
                           const char *signature, int nin, int nout, PyObject *owner)
{
    void *address = PyLong_AsVoidPtr(function);
    if (address == NULL) {
        if (!PyErr_Occurred()) {
            PyErr_Format(PyExc_ValueError, "%U: the function's address is 0", name);
        }
        return NULL;
    }
    if (nin < 0 || nout < 0 || nin >= MAX_ARGUMENTS || nout >= MAX_ARGUMENTS || nin + nout + 1 > MAX_ARGUMENTS) {
        PyErr_Format(PyExc_ValueError, "%U: %d inputs and %d outputs; with the status, at most %d are supported", name,
                     nin, nout, (int)MAX_ARGUMENTS);
        return NULL;
    }
    kernel *k = new_kernel(name, doc, geometry);
    if (k == NULL) {
        return NULL;
    }
    k->function = (batch_function)(uintptr_t)address;
    k->nin = nin;
    k->nout = nout;
    PyObject *capsule = PyCapsule_New(k, CAPSULE_NAME, free_kernel);
    if (capsule == NULL) {
        PyMem_RawFree(k);
        return NULL;
    }
    PyObject *keeper = PyTuple_Pack(2, capsule, owner); /* a tuple, because the garbage collector can see through it */
    Py_DECREF(capsule);
    if (keeper == NULL) {
        return NULL;
    }
    PyUFuncObject *ufunc = new_ufunc(k, signature);
    if (ufunc == NULL) {
        Py_DECREF(keeper);
        return NULL;
    }
    ufunc->obj = keeper; /* the ufunc drops it when it goes */
    if (!PyObject_GC_IsTracked((PyObject *)ufunc)) {
        PyObject_GC_Track(ufunc);
    }
    return (PyObject *)ufunc;
}

static PyObject *make(PyObject *module, PyObject *args)
{
    (void)module;
    PyObject *name, *doc, *function, *geometry, *owner;
    const char *signature;
    int nin, nout;
    if (!PyArg_ParseTuple(args, "UUO!OsiiO:make", &name, &doc, &PyLong_Type, &function, &geometry, &signature, &nin,
                          &nout, &owner)) {
        return NULL;
    }
    if (geometry == Py_None) {
        return make_from(name, doc, function, NULL, signature, nin, nout, owner);
    }
    Py_buffer buffer;
    if (PyObject_GetBuffer(geometry, &buffer, PyBUF_FULL_RO) < 0) {
        return NULL;
    }
    PyObject *ufunc = make_from(name, doc, function, &buffer, signature, nin, nout, owner);
    PyBuffer_Release(&buffer);
    return ufunc;
}

/* -------------------------------------------------------------------------------------------------------- module -- */

static PyMethodDef methods[] = {
    {"make", make, METH_VARARGS,
     "make(name, doc, function, geometry, signature, nin, nout, owner) -> ufunc\n\n"
     "A generalized ufunc of the batch kernel at the address `function`; see krhpr.native.adapter.make_gufunc."},
    {NULL, NULL, 0, NULL},
};

static int execute(PyObject *module)
{
    (void)module;
    _Static_assert(sizeof(npy_intp) == sizeof(ptrdiff_t), "steps are handed over as they are");
    import_array1(-1);
    import_umath1(-1);
    return 0;
}

static PyModuleDef_Slot slots[] = {
    {Py_mod_exec, (void *)execute},
#ifdef Py_mod_gil
    {Py_mod_gil, Py_MOD_GIL_NOT_USED},
#endif
    {0, NULL},
};

static struct PyModuleDef definition = {
    PyModuleDef_HEAD_INIT,
    .m_name = "_gufunc",
    .m_doc = "NumPy generalized ufuncs of compiled batch kernels.",
    .m_size = 0,
    .m_methods = methods,
    .m_slots = slots,
};

PyMODINIT_FUNC PyInit__gufunc(void)
{
    return PyModuleDef_Init(&definition);
}
