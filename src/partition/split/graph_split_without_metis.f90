!> A build without METIS: splitting a graph is one clear error.
submodule(sg_graph_split) graph_split_without_metis
  use sg_error, only: fail
  implicit none

contains

  module procedure graph_splits
  is_available = .false.
  end procedure graph_splits

  module procedure split_graph
  call fail(error, 'this program was built without METIS, which the method graph needs; the method boxes does without')
  end procedure split_graph
end submodule graph_split_without_metis
