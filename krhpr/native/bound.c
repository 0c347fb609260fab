/* Calls a compiled batch kernel on one element in buffers that are bound once: the quickest way from Python to C.
 *
 * A `Bound` holds the function, a private copy of the geometry, and the buffers of its arrays, which cannot be resized
 * meanwhile. A call takes no arguments, keeps the interpreter's lock (it is shorter than giving it back), and returns the
 * status.
 */
#define PY_SSIZE_T_CLEAN
#include <Python.h>
#include <structmember.h>

#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* As in gufunc.c. */
typedef int (*batch_function)(const void *geometry, size_t count, const double *const in[], const ptrdiff_t in_step[],
                              double *const out[], const ptrdiff_t out_step[], int *status, ptrdiff_t status_step);

enum { MAX_ARGUMENTS = 32, GEOMETRY_ALIGNMENT = 64 };

typedef struct {
    PyObject_HEAD
    vectorcallfunc vectorcall;
    batch_function function;
    const void *geometry;
    const double *in[MAX_ARGUMENTS];
    double *out[MAX_ARGUMENTS];
    int buffer_count;
    Py_buffer buffers[MAX_ARGUMENTS];
    void *memory;
    PyObject *owner, *inputs, *outputs;
} bound;

static const ptrdiff_t NO_STEPS[MAX_ARGUMENTS];

static PyObject *call(PyObject *callable, PyObject *const *arguments, size_t flags, PyObject *names)
{
    (void)arguments;
    bound *b = (bound *)callable;
    if (PyVectorcall_NARGS(flags) != 0 || (names != NULL && PyTuple_GET_SIZE(names) != 0)) {
        PyErr_SetString(PyExc_TypeError, "a bound function takes no arguments: write to its inputs, read its outputs");
        return NULL;
    }
    int status = 0;
    b->function(b->geometry, 1, b->in, NO_STEPS, b->out, NO_STEPS, &status, 0);
    return PyLong_FromLong(status);
}

/* Takes hold of one array of doubles; NULL, with an exception, where it is not fit for that. */
static double *take(bound *b, PyObject *array, int writable)
{
    Py_buffer *buffer = &b->buffers[b->buffer_count];
    if (PyObject_GetBuffer(array, buffer, PyBUF_C_CONTIGUOUS | PyBUF_FORMAT | (writable ? PyBUF_WRITABLE : 0)) < 0) {
        return NULL;
    }
    ++b->buffer_count;
    if (buffer->format == NULL || strcmp(buffer->format, "d") != 0 || (uintptr_t)buffer->buf % _Alignof(double) != 0) {
        PyErr_Format(PyExc_TypeError, "a bound array holds doubles in C order, not %R", array);
        return NULL;
    }
    return buffer->buf;
}

static int take_all(bound *b, PyObject *inputs, PyObject *outputs)
{
    const Py_ssize_t n_in = PyTuple_GET_SIZE(inputs), n_out = PyTuple_GET_SIZE(outputs);
    if (n_in + n_out > MAX_ARGUMENTS) {
        PyErr_Format(PyExc_ValueError, "at most %d arrays can be bound, not %zd", (int)MAX_ARGUMENTS, n_in + n_out);
        return -1;
    }
    for (Py_ssize_t i = 0; i < n_in; ++i) {
        if ((b->in[i] = take(b, PyTuple_GET_ITEM(inputs, i), 0)) == NULL) {
            return -1;
        }
    }
    for (Py_ssize_t i = 0; i < n_out; ++i) {
        if ((b->out[i] = take(b, PyTuple_GET_ITEM(outputs, i), 1)) == NULL) {
            return -1;
        }
    }
    return 0;
}

static int copy_geometry(bound *b, PyObject *geometry)
{
    if (geometry == Py_None) {
        return 0;
    }
    Py_buffer buffer;
    if (PyObject_GetBuffer(geometry, &buffer, PyBUF_SIMPLE) < 0) {
        return -1;
    }
    b->memory = PyMem_RawMalloc((size_t)buffer.len + GEOMETRY_ALIGNMENT);
    if (b->memory != NULL) {
        char *place = b->memory;
        place += (GEOMETRY_ALIGNMENT - (uintptr_t)place % GEOMETRY_ALIGNMENT) % GEOMETRY_ALIGNMENT;
        memcpy(place, buffer.buf, (size_t)buffer.len);
        b->geometry = place;
    }
    PyBuffer_Release(&buffer);
    if (b->memory == NULL) {
        PyErr_NoMemory();
        return -1;
    }
    return 0;
}

static PyObject *new(PyTypeObject *type, PyObject *arguments, PyObject *keywords)
{
    static char *names[] = {"function", "geometry", "inputs", "outputs", "owner", NULL};
    unsigned long long function;
    PyObject *geometry, *inputs, *outputs, *owner;
    if (!PyArg_ParseTupleAndKeywords(arguments, keywords, "KOO!O!O", names, &function, &geometry, &PyTuple_Type, &inputs,
                                     &PyTuple_Type, &outputs, &owner)) {
        return NULL;
    }
    bound *b = (bound *)type->tp_alloc(type, 0);
    if (b == NULL) {
        return NULL;
    }
    b->vectorcall = call;
    b->function = (batch_function)(uintptr_t)function;
    b->owner = Py_NewRef(owner);
    b->inputs = Py_NewRef(inputs);
    b->outputs = Py_NewRef(outputs);
    if (take_all(b, inputs, outputs) < 0 || copy_geometry(b, geometry) < 0) {
        Py_DECREF(b);
        return NULL;
    }
    return (PyObject *)b;
}

static int traverse(PyObject *self, visitproc visit, void *arg)
{
    bound *b = (bound *)self;
    Py_VISIT(Py_TYPE(self));
    Py_VISIT(b->owner);
    Py_VISIT(b->inputs);
    Py_VISIT(b->outputs);
    for (int i = 0; i < b->buffer_count; ++i) {
        Py_VISIT(b->buffers[i].obj);
    }
    return 0;
}

static void deallocate(PyObject *self)
{
    bound *b = (bound *)self;
    PyTypeObject *type = Py_TYPE(self);
    PyObject_GC_UnTrack(self);
    for (int i = 0; i < b->buffer_count; ++i) {
        PyBuffer_Release(&b->buffers[i]);
    }
    Py_CLEAR(b->owner);
    Py_CLEAR(b->inputs);
    Py_CLEAR(b->outputs);
    PyMem_RawFree(b->memory);
    type->tp_free(self);
    Py_DECREF(type);
}

static PyMemberDef members[] = {
    {"inputs", T_OBJECT, offsetof(bound, inputs), READONLY, "The arrays that a call reads, by name."},
    {"outputs", T_OBJECT, offsetof(bound, outputs), READONLY, "The arrays that a call writes, by name."},
    {"__vectorcalloffset__", T_PYSSIZET, offsetof(bound, vectorcall), READONLY, NULL},
    {NULL, 0, 0, 0, NULL},
};

static PyType_Slot type_slots[] = {
    {Py_tp_doc, "Bound(function, geometry, inputs, outputs, owner)\n\n"
                "The batch kernel at the address `function` on one element in these arrays; see krhpr.native.adapter.bind."},
    {Py_tp_new, new},
    {Py_tp_call, PyVectorcall_Call},
    {Py_tp_traverse, traverse},
    {Py_tp_dealloc, deallocate},
    {Py_tp_members, members},
    {0, NULL},
};

static PyType_Spec type_spec = {
    .name = "krhpr.native._bound.Bound",
    .basicsize = sizeof(bound),
    .flags = Py_TPFLAGS_DEFAULT | Py_TPFLAGS_HAVE_GC | Py_TPFLAGS_HAVE_VECTORCALL | Py_TPFLAGS_IMMUTABLETYPE,
    .slots = type_slots,
};

static int execute(PyObject *module)
{
    _Static_assert(sizeof(unsigned long long) >= sizeof(uintptr_t), "an address fits");
    PyObject *type = PyType_FromModuleAndSpec(module, &type_spec, NULL);
    if (type == NULL) {
        return -1;
    }
    const int added = PyModule_AddType(module, (PyTypeObject *)type);
    Py_DECREF(type);
    return added;
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
    .m_name = "_bound",
    .m_doc = "Compiled kernels on buffers that are bound once.",
    .m_size = 0,
    .m_slots = slots,
};

PyMODINIT_FUNC PyInit__bound(void)
{
    return PyModuleDef_Init(&definition);
}
