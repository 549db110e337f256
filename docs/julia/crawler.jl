# SPDX-License-Identifier: GPL-3.0-or-later
# strut from Julia, by ccall on libstrut.so.0 (docs/api.md): a run, and a controller on the crawler.
#
#   julia docs/julia/crawler.jl models/crawler/crawler.yaml
#
# LD_LIBRARY_PATH leads to a library that is not installed where the system looks.

const lib = "libstrut.so.0"
const Handle = Ptr{Cvoid}

"Raises what a call left in its error."
function raise(error::Ref{Handle})
    text = unsafe_string(ccall((:strutlib_error_report, lib), Cstring, (Handle,), error[]))
    ccall((:strutlib_error_free, lib), Cvoid, (Handle,), error[])
    Base.error(text)
end

function open_scene(path; settings...)
    names = [String(k) for k in keys(settings)]
    texts = [string(v) for v in values(settings)]
    error = Ref{Handle}(C_NULL)
    scene = ccall((:strutlib_open, lib), Handle,
                  (Cstring, Csize_t, Ptr{Cstring}, Ptr{Cstring}, Ref{Handle}),
                  path, length(names), names, texts, error)
    scene == C_NULL && raise(error)
    scene
end

function run(scene; options...)
    names = [String(k) for k in keys(options)]
    texts = [string(v) for v in values(options)]
    error = Ref{Handle}(C_NULL)
    result = ccall((:strutlib_run, lib), Handle,
                   (Handle, Csize_t, Ptr{Cstring}, Ptr{Cstring}, Handle, Ref{Handle}),
                   scene, length(names), names, texts, C_NULL, error)
    result == C_NULL && raise(error)
    result
end

function number(result, name)
    value = Ref{Cdouble}(NaN)
    ccall((:strutlib_result_number, lib), Cint, (Handle, Cstring, Ref{Cdouble}), result, name, value)
    value[]
end

"A vector of a result, such as \"position.n1.y\", as a copy; strides are counted in doubles."
function vector(result, name)
    data = Ref{Ptr{Cdouble}}(C_NULL)
    dimensions = Ref{Cint}(0)
    shape, stride = zeros(Csize_t, 4), zeros(Csize_t, 4)
    found = ccall((:strutlib_result_array, lib), Cint,
                  (Handle, Cstring, Ref{Ptr{Cdouble}}, Ref{Cint}, Ptr{Csize_t}, Ptr{Csize_t}),
                  result, name, data, dimensions, shape, stride)
    (found == 1 && dimensions[] == 1) || Base.error("no vector '$name'")
    [unsafe_load(data[], 1 + (i - 1) * stride[1]) for i in 1:shape[1]]
end

"A live array of a simulation as a matrix that shares its memory, components first."
function live(simulation, name, ask = :strutlib_simulation_array)
    data = Ref{Ptr{Cdouble}}(C_NULL)
    dimensions = Ref{Cint}(0)
    shape, stride = ones(Csize_t, 4), zeros(Csize_t, 4)
    ask == :strutlib_simulation_array ?
        ccall((:strutlib_simulation_array, lib), Cint,
              (Handle, Cstring, Ref{Ptr{Cdouble}}, Ref{Cint}, Ptr{Csize_t}, Ptr{Csize_t}),
              simulation, name, data, dimensions, shape, stride) :
        ccall((:strutlib_simulation_input, lib), Cint,
              (Handle, Cstring, Ref{Ptr{Cdouble}}, Ref{Cint}, Ptr{Csize_t}, Ptr{Csize_t}),
              simulation, name, data, dimensions, shape, stride)
    data[] == C_NULL && Base.error("no array '$name'")
    components = dimensions[] > 1 ? shape[2] : 1
    unsafe_wrap(Array, data[], (Int(components), Int(shape[1])))
end

function control(scene, duration)
    error = Ref{Handle}(C_NULL)
    simulation = ccall((:strutlib_simulation_open, lib), Handle,
                       (Handle, Csize_t, Ptr{Cvoid}, Ptr{Cvoid}, Handle, Ref{Handle}),
                       scene, 0, C_NULL, C_NULL, C_NULL, error)
    simulation == C_NULL && raise(error)
    velocity = live(simulation, "velocity")                           # (2, nodes)
    rest = live(simulation, "rest", :strutlib_simulation_input)       # (1, members)
    driven = 1 + ccall((:strutlib_index, lib), Clong, (Handle, Cstring, Cstring), scene, "members", "m8")
    drawn = rest[1, driven]
    time() = ccall((:strutlib_simulation_time, lib), Cdouble, (Handle,), simulation)
    while time() < duration
        rest[1, driven] = drawn + (velocity[1, 1] > 0 ? 0.1e-3 : -0.1e-3)
        status = ccall((:strutlib_simulation_advance, lib), Cint, (Handle, Clong, Ref{Handle}),
                       simulation, 10, error)
        status == 0 || raise(error)
    end
    println("after $(time()) s the first node moves at $(velocity[1, 1]) m/s")
    ccall((:strutlib_simulation_close, lib), Cvoid, (Handle,), simulation)
end

scene = open_scene(ARGS[1]; frequency = "10 Hz")
result = run(scene; accuracy = "0.5 %")
println("velocity $(number(result, "velocity")) m/s")
println("node n1 rises to $(maximum(vector(result, "position.n1.y"))) m")
ccall((:strutlib_result_free, lib), Cvoid, (Handle,), result)
control(scene, 0.5)
ccall((:strutlib_close, lib), Cvoid, (Handle,), scene)
