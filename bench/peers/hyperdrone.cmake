# HyperDrone's dynamics on the processor alone: nothing of this is used, and none of it is looked for.
foreach(part BACKEND_DISABLE_CUDA DISABLE_CLI11 DISABLE_HDF5 DISABLE_ZLIB DISABLE_TENSORBOARD)
    set(RL_TOOLS_${part} ON)
endforeach()
