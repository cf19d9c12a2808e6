!> On which branch an instant was found: what has been verified on the step to it.
!>
!> SAME: on every substep the prediction was off by less than a tenth of the distance within which there is one root
!> only (Newton and Kantorovich), and the determinants of all blocks, or that of all equations at once, have kept their
!> signs. CROSSED: the same, but for change points that were passed, each within a short substep, and listed.
module branch_certificate
   use kinds, only: wp
   implicit none
   private
   public :: branch_t, certificate_counts_t
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
end module branch_certificate
