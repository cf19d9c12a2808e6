!> The motion of a set at one instant, as the writers take it: the motions of its independent mechanisms (its parts),
!> their errors, and the rows that the set asks for, in the order of the cards.
module set_motion
   use kinds, only: wp
   use mechanism, only: mechanism_t, request_t, wanted_links
   use motion, only: motion_t, new_motion, flag_none
   use independent, only: set_t, divide
   use set_members, only: requests_of
   use columns, only: columns_of_rows, forms, of_length, of_angle
   use structure, only: structure_report_t
   use blocks, only: blocks_t, geometry_t, link_order_t, largest_known
   use block_state, only: state_t, new_state, set_direction
   use block_solver, only: solve_explicit
   use link_motion, only: new_chain, move_links
   use points, only: row_t, find_row
   use separations, only: motions_apart
   use error_estimate, only: error_estimate_t
   use sensitivities, only: sensitivities_t
   use motion_proof, only: motion_proof_t
   implicit none
   private
   public :: set_motion_t, new_set_motion, is_flagged, has_words, find_row_in_set, find_row_of_position, apart_from

   !> The motion of a set.
   type, extends(set_t) :: set_motion_t
      type(motion_t), allocatable :: motions(:)     !< (parts)
      type(error_estimate_t), allocatable :: errors(:)   !< (parts) of their rows
      type(sensitivities_t), allocatable :: sensitivities(:)   !< (parts) of their rows to numbers with tolerances
      type(motion_proof_t), allocatable :: proofs(:)   !< (parts) for card PROVE
      logical :: has_begun = .false.                !< the first instant is taken
      type(motion_t), allocatable :: first(:)       !< (parts) at the first instant; none if no extremes are asked for
   end type set_motion_t

contains

   !> Divides a set into its parts, at rest. Requests for ratios that the drive cannot move get no rows.
   subroutine new_set_motion(m, motions, structure_report)
      type(mechanism_t), intent(in) :: m
      type(set_motion_t), intent(out) :: motions   !< at rest
      type(structure_report_t), intent(inout) :: structure_report   !< of the set, which loses its division
      type(request_t), allocatable :: requests(:)
      integer :: c

      if (allocated(structure_report%set)) then
         motions%set_t = structure_report%set
         deallocate (structure_report%set)
      else
         call divide(m, motions%set_t)
      end if

      allocate (motions%motions(motions%count), motions%errors(motions%count), motions%sensitivities(motions%count), &
         motions%proofs(motions%count))
      allocate (motions%first(merge(motions%count, 0, any([(any(motions%parts(c)%requests%extremes), c=1, &
         motions%count)]))))
      do c = 1, motions%count
         motions%motions(c) = new_motion(size(motions%parts(c)%links))
         if (all(motions%parts(c)%requests%drive == 0)) cycle
         call leave_out_unmoved(motions%parts(c), structure_report%structures(c)%blocks, &
            structure_report%structures(c)%geometry)
      end do

      ! `leave_out_unmoved` takes all rows from a request for a ratio.
      if (.not. allocated(motions%columns)) return
      requests = requests_of(motions)
      motions%columns = pack(motions%columns, requests(motions%columns%request)%drive == 0 .or. &
         requests(motions%columns%request)%in_columns)
   end subroutine new_set_motion

   !> Takes the rows from requests for ratios that the drive cannot move. The test is at positions at which no loop
   !> closes, and the unknowns that depend on the drive have arbitrary rates: a drive that moves something there can
   !> move it anywhere but at single positions.
   subroutine leave_out_unmoved(m, b, x)
      type(mechanism_t), intent(inout) :: m
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      type(link_order_t) :: chain
      type(state_t) :: state
      type(motion_t) :: q
      type(row_t) :: row
      type(request_t) :: request
      integer :: moves(0:b%unknowns), d, i, k
      logical :: finite
      real(wp) :: largest(of_length:of_angle)
      !> Parts of the largest rate of a length or an angle: smaller ones are roundings.
      real(wp), parameter :: rounded_part = sqrt(epsilon(1.0_wp))

      if (.not. b%solvable) return
      chain = new_chain(m, b, x, wanted_links(m))
      do d = 1, size(m%drives)
         if (all(m%requests%drive /= d)) cycle
         state = new_state(b, size(m%drives))
         do k = 1, b%unknowns
            state%u(k)%value = arbitrary(k)
            call set_direction(b, k, state)
         end do
         state%drive_value(0, 1:) = arbitrary([(k, k=1, size(m%drives))] + 2*b%unknowns)
         state%drive_value(1, d) = 1.0_wp

         moves = 0
         do i = 1, size(b%list)
            associate (own => b%unknown(b%list(i)%first:b%list(i)%last))
               if (any(b%rows(b%list(i)%first_row:b%list(i)%last_row)%drive == d) .or. largest_known(b, i, moves) > 0) &
                  moves(own) = 1
               if (b%list(i)%explicit) then
                  call solve_explicit(b, x, i, state)
               else
                  state%u(own)%rate = moves(own)*arbitrary(own + b%unknowns)
               end if
            end associate
         end do

         q = new_motion(size(m%links))
         q%known = 2
         call move_links(chain, chain%wanted, state, q, finite)
         largest = [maxval(abs(q%velocity(:2, :))), maxval(abs(q%velocity(3, :)))]
         do i = 1, size(m%requests)
            if (m%requests(i)%drive /= d) cycle
            request = m%requests(i)
            request%drive = 0
            call find_row(m, q, request, row)
            if (abs(row%value(1, 1)) > rounded_part*largest(columns_of_rows(forms(row%form)%first)%dimension)) cycle
            m%requests(i)%every = 0
            m%requests(i)%extremes = .false.
            m%requests(i)%in_columns = .false.
         end do
      end do

   contains

      !> Gives a number between 0.25 and 1.25 that has nothing to do with those of others.
      elemental real(wp) function arbitrary(k)
         integer, intent(in) :: k            !< any number

         arbitrary = 0.25_wp + mod(k*0.6180339887498949_wp + 0.31_wp*sin(real(k, wp))**2, 1.0_wp)
      end function arbitrary
   end subroutine leave_out_unmoved

   !> Tells whether some part has not all of its motion.
   pure logical function is_flagged(motions)
      type(set_motion_t), intent(in) :: motions   !< at an instant

      is_flagged = any(motions%motions%flag /= flag_none)
   end function is_flagged

   !> Tells whether the instant has marks or diagnostics in addition to its numbers.
   pure logical function has_words(motions)
      type(set_motion_t), intent(in) :: motions   !< at an instant
      integer :: c

      has_words = .false.
      do c = 1, motions%count
         has_words = has_words .or. motions%motions(c)%flag /= flag_none .or. allocated(motions%motions(c)%diagnostics)
      end do
   end function has_words

   !> Finds the row of a request of the set.
   pure subroutine find_row_in_set(motions, i, row)
      type(set_motion_t), intent(in) :: motions   !< at an instant
      integer, intent(in) :: i               !< the request's number among those of the set
      type(row_t), intent(inout) :: row      !< as far as the motion is known

      ! The request in its place: as the result of a function it would be copied.
      associate (c => motions%rows(i)%part)
         call find_row(motions%parts(c), motions%motions(c), motions%parts(c)%requests(motions%rows(i)%number), row)
      end associate
   end subroutine find_row_in_set

   !> Finds the row of a request at another position of its mechanism, without velocities.
   pure subroutine find_row_of_position(motions, i, position, row)
      type(set_motion_t), intent(in) :: motions   !< whose parts and origins it has
      integer, intent(in) :: i               !< the request's number among those of the set
      real(wp), intent(in) :: position(:, :)   !< (3, links): x and y (length) from the motion's origin, phi (rad)
      type(row_t), intent(inout) :: row      !< with its position; nothing else of it is known
      type(motion_t) :: q

      associate (c => motions%rows(i)%part)
         q = new_motion(size(position, 2))
         q%known = 0
         q%origin = motions%motions(c)%origin
         q%position = position
         call find_row(motions%parts(c), q, motions%parts(c)%requests(motions%rows(i)%number), row)
      end associate
   end subroutine find_row_of_position

   !> Finds how far the last motion of an independent mechanism is from another one at most (3): places, angles and
   !> velocities, in characteristic lengths, rad and characteristic rates. All three are huge if no position is known.
   !> Velocities that are not unique count as equal.
   pure function apart_from(motions, part, other) result(apart)
      type(set_motion_t), intent(in) :: motions   !< at an instant
      integer, intent(in) :: part            !< the number of the independent mechanism
      type(motion_t), intent(in) :: other    !< of the same mechanism
      real(wp) :: apart(3)

      apart = motions_apart(motions%parts(part), other, motions%motions(part))
   end function apart_from
end module set_motion

