!> The results of card PROVE: a line for each printed instant, with the steps to it since the one before; why instants
!> are not proved; and the counts.
module proofs
   use kinds, only: wp
   use motion, only: flag_none
   use continuation, only: branch_crossed
   use motion_proof, only: holds
   use set_analysis, only: set_analysis_t
   implicit none
   private
   public :: proofs_t, reason_t, record_proof

   !> The proof of a printed instant, and of the steps to it from the last one.
   type :: proof_row_t
      integer :: step = 0                        !< number of the instant
      logical :: is_proved = .true.              !< the position, and all steps to it
      integer :: parts = 0                       !< into which the steps were divided
      real(wp) :: tube = 0.0_wp                  !< largest radius, in rad and units of the blocks
      real(wp) :: bounds(0:2) = 0.0_wp           !< of errors, in the characteristic length and rate
   end type proof_row_t

   !> Why an instant is not proved.
   type :: reason_t
      integer :: step = 0                        !< number of the instant
      integer :: part = 1                        !< the independent mechanism
      integer :: flag = flag_none, singularity = 0   !< of its motion
      logical :: is_crossed = .false.            !< a change point may be in the step
      integer :: too_many = 0                    !< parts into which the step is divided, if these are too many
      integer, allocatable :: links(:)           !< whose position is not proved
   end type reason_t

   !> The proofs of a run.
   type :: proofs_t
      type(proof_row_t), allocatable :: lines(:)      !< (instants at most) with room for further ones
      integer :: count = 0                       !< of finished lines; the next one is in the making
      type(reason_t), allocatable :: reasons(:)  !< (up to `max_reasons`) the first ones
      integer :: instants = 0, proved = 0        !< in all
      real(wp) :: closure_error = 0.0_wp         !< bound, of redundant equations, in units of the blocks
   end type proofs_t

   !> At most so many reasons are kept; further ones are only counted.
   integer, parameter :: max_reasons = 50

contains

   !> Takes the proof of an instant, to which the set has advanced: adds it to the line of the next printed instant.
   subroutine record_proof(proofs, set, k, due)
      type(proofs_t), intent(inout) :: proofs   !< of the run so far
      type(set_analysis_t), intent(in) :: set   !< at the instant, with its proofs
      integer, intent(in) :: k               !< the number of the instant, from 0
      logical, intent(in) :: due             !< the instant is printed
      type(reason_t) :: reason
      integer :: c

      if (.not. allocated(proofs%lines)) allocate (proofs%lines(max(2, set%now%steps + size(set%now%at) + 2)), &
         proofs%reasons(0))
      proofs%instants = proofs%instants + 1

      associate (line => proofs%lines(proofs%count + 1))
         do c = 1, set%now%count
            associate (proof => set%now%proofs(c))
               line%parts = line%parts + proof%step%parts
               line%tube = max(line%tube, proof%step%radius)
               if (proof%is_proved) proofs%closure_error = max(proofs%closure_error, proof%closure_error)
               if (holds(proof)) cycle
               line%is_proved = .false.
               if (size(proofs%reasons) == max_reasons) cycle
               associate (q => set%now%motions(c))
                  reason = reason_t(k, c, q%flag, q%singularity, set%list(c)%branch%kind == branch_crossed, &
                     proof%too_many)
               end associate
               if (allocated(proof%failed)) reason%links = proof%failed
               proofs%reasons = [proofs%reasons, reason]
            end associate
         end do
         if (all(holds(set%now%proofs))) proofs%proved = proofs%proved + 1

         if (.not. due) return
         line%step = k
         line%bounds = set_bounds(set)
         proofs%count = proofs%count + 1
      end associate
   end subroutine record_proof

   !> Finds the largest proved bounds (0:2) of the errors of any link, in the characteristic length and rate of its
   !> mechanism.
   pure function set_bounds(set) result(largest)
      type(set_analysis_t), intent(in) :: set   !< at an instant, with its proofs
      real(wp) :: largest(0:2)
      integer :: c

      largest = 0.0_wp
      do c = 1, size(set%list)
         if (.not. set%now%proofs(c)%is_proved) cycle
         associate (found => set%now%proofs(c)%largest, sizes => set%estimators(c)%sizes)
            largest = max(largest, max(found(1, :)/sizes%length, found(2, :))/sizes%rate**[0, 1, 2])
         end associate
      end do
   end function set_bounds
end module proofs
