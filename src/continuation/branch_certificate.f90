!> On which branch an instant was found: what has been verified on the way to it.
!>
!> SAME: on every part of the way the prediction was off by less than a tenth of the distance within which there is
!> one root only (Newton and Kantorovich), and the determinants of all blocks, or that of all equations at once, have
!> kept their signs.
!> CROSSED: the same, but for change points that were passed, each within a short step, and told.
module branch_certificate
   use kinds, only: wp
   implicit none
   private
   public :: branch_t, certificate_counts_t, count_in, worst_branch, branch_word
   public :: branch_none, branch_first, branch_same, branch_crossed

   integer, parameter :: branch_none = 0      !< nothing is verified
   integer, parameter :: branch_first = 1     !< chosen by the deck's rough position
   integer, parameter :: branch_same = 2      !< that of the motion that is followed
   integer, parameter :: branch_crossed = 3   !< the same, through change points

   !> `parts` of the way that were kept; `kantorovich_ratio`: the largest of their corrections, over the distance
   !> within which the
   !> root is the only one.
   type :: branch_t
      integer :: kind = branch_none
      integer :: parts = 0
      real(wp) :: kantorovich_ratio = 0.0_wp
   end type branch_t

   !> Instants with a position: followed, and found without that (but for the first); change points passed.
   type :: certificate_counts_t
      integer :: followed = 0, passed = 0, uncertain = 0
   end type certificate_counts_t

contains

   !> Counts an instant found on the branch `b`, on the way to which so many change points were `passed`.
   pure subroutine count_in(certificate_counts, b, passed)
      type(certificate_counts_t), intent(inout) :: certificate_counts
      type(branch_t), intent(in) :: b
      integer, intent(in) :: passed

      certificate_counts%passed = certificate_counts%passed + passed
      if (b%kind == branch_none) certificate_counts%uncertain = certificate_counts%uncertain + 1
      if (b%kind >= branch_same) certificate_counts%followed = certificate_counts%followed + 1
   end subroutine count_in

   !> What is verified of several independent motions together, each found on one of the branches `b`.
   pure type(branch_t) function worst_branch(b) result(worst)
      type(branch_t), intent(in) :: b(:)

      worst%kind = maxval(b%kind)
      if (any(b%kind == branch_first)) worst%kind = branch_first
      if (any(b%kind == branch_none)) worst%kind = branch_none
      worst%parts = maxval(b%parts)
      worst%kantorovich_ratio = maxval(b%kantorovich_ratio)
   end function worst_branch

   !> For the protocol.
   pure function branch_word(b) result(word)
      type(branch_t), intent(in) :: b
      character(7) :: word
      character(7), parameter :: words(0:3) = [character(7) :: 'NONE', 'FIRST', 'SAME', 'CROSSED']

      word = words(b%kind)
   end function branch_word
end module branch_certificate
