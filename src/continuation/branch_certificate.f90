!> On which branch an instant was found: what has been verified on the step to it.
!>
!> SAME: on every substep the prediction was off by less than a tenth of the distance within which there is one root
!> only (Newton and Kantorovich), and the determinants of all blocks, or that of all equations at once, have kept their
!> signs. CROSSED: the same, but for change points that were passed, each within a short substep, and listed.
module branch_certificate
   use kinds, only: wp
   implicit none
   private
   public :: branch_t, certificate_counts_t, count_in, branch_word
   public :: branch_none, branch_first, branch_same, branch_crossed

   integer, parameter :: branch_none = 0      !< nothing is verified
   integer, parameter :: branch_first = 1     !< chosen by the deck's estimated position
   integer, parameter :: branch_same = 2      !< that of the motion that is followed
   integer, parameter :: branch_crossed = 3   !< the same, through change points

   !> What is certified of one step.
   type :: branch_t
      integer :: kind = branch_none              !< branch_first, ...
      integer :: substeps = 0                    !< made on the step
      real(wp) :: kantorovich_ratio = 0.0_wp     !< their largest correction over the distance of the next root
   end type branch_t

   !> Sums over the instants of a set, for the listing's line CONTINUATION.
   type :: certificate_counts_t
      integer :: followed = 0    !< instants with a certificate
      integer :: passed = 0      !< change points
      integer :: uncertain = 0   !< instants with a position but without a certificate, the first apart
   end type certificate_counts_t

contains

   !> Counts an instant found on the branch `b` beyond so many change points `passed`.
   pure subroutine count_in(counts, b, passed)
      type(certificate_counts_t), intent(inout) :: counts
      type(branch_t), intent(in) :: b
      integer, intent(in) :: passed

      counts%passed = counts%passed + passed
      if (b%kind == branch_none) counts%uncertain = counts%uncertain + 1
      if (b%kind >= branch_same) counts%followed = counts%followed + 1
   end subroutine count_in

   !> The word of the log for the branch `b`.
   pure function branch_word(b) result(word)
      type(branch_t), intent(in) :: b
      character(7) :: word
      character(7), parameter :: words(0:3) = [character(7) :: 'NONE', 'FIRST', 'SAME', 'CROSSED']

      word = words(b%kind)
   end function branch_word
end module branch_certificate
