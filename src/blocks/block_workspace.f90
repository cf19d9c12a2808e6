!> Room to solve the blocks in, one after another.
module block_workspace
   use kinds, only: wp
   use klu, only: klu_t
   use block_matrix, only: entries_of, work_length
   use blocks, only: blocks_t
   implicit none
   private
   public :: workspace_t, make_workspace

   !> Room for the widest block, and the factors of each sparse one. Never copied: see klu_t.
   type :: workspace_t
      real(wp), allocatable :: a(:), r(:), start(:), work(:)
      integer, allocatable :: pivots(:), iwork(:)
      type(klu_t), allocatable :: sparse(:)       !< (0:patterns), 0 for dense blocks
   end type workspace_t

contains

   !> Room for every block of `b`.
   subroutine make_workspace(w, b)
      type(workspace_t), intent(out) :: w
      type(blocks_t), intent(in) :: b
      integer :: i, entries, rows, length

      entries = 0
      rows = 0
      length = 0
      do i = 1, size(b%list)
         rows = max(rows, b%list(i)%shape%rows)
         length = max(length, work_length(b%list(i)%shape))
         entries = max(entries, entries_of(b%list(i)%shape))
      end do
      allocate (w%a(entries), w%r(2*rows), w%start(rows), w%work(length), source=0.0_wp)
      allocate (w%pivots(rows), w%iwork(rows), source=0)
      allocate (w%sparse(0:size(b%patterns)))
      do i = 1, size(b%patterns)
         w%sparse(i)%pattern = b%patterns(i)
      end do
   end subroutine make_workspace
end module block_workspace
